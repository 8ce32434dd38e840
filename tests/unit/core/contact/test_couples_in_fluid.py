"""Couples of laws in a fluid: a disk that turns over a floor, in a film that its coarse mesh does not resolve."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History

RADIUS = 0.1
ALLOWED = 0.005


@cache
def turning(model: str = "navier-stokes", stepping: str = "substeps", sliding: bool = True) -> History:
    disk = {"type": "sphere", "radius": RADIUS, "density": 4.0, "angular_velocity": 40.0}
    film = {"law": "lubrication", "range": 0.016, "cutoff": 1e-3, "viscosity": 0.05, "sliding": sliding}
    return rigidfluid.run(
        scene_from_dict(
            {
                "scene": {"name": "turning", "dimension": 2},
                "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -20.0], "model": model},
                "domain": {"lower": [0.0, 0.0], "upper": [0.8, 0.6]},
                "body": [disk | {"position": [0.3, RADIUS + 0.012]}],
                "interaction": [film, {"law": "normal", "range": 0.008, "epsilon": 1e-4}],
                "contact": {"stepping": stepping},
                "mesh": {"size": 0.1, "size_body": 0.04, "refinements": 0},
                "time": {"end": 0.04, "step": 4e-3},
                "output": {"every": 0.04},
            }
        )
    )


@pytest.mark.parametrize(
    ("model", "stepping"),
    [
        ("navier-stokes", "substeps"),
        pytest.param("navier-stokes", "implicit", marks=pytest.mark.long),
        ("stokes", "substeps"),
    ],
)
def test_no_energy_is_made_or_lost(model: str, stepping: str) -> None:
    """Of what was put in, after the first step, which sets the fluid in motion at once."""
    energy = turning(model, stepping).energy
    put_in = energy["kinetic"][0] + energy["gravity"].max()
    residual = (energy["residual"][1:] - energy["residual"][1]) / put_in
    assert np.abs(residual).max() < ALLOWED
    assert np.all(np.diff(energy["contact_loss"]) >= 0.0)
    assert energy["contact_loss"][-1] > 0.05 * put_in


@pytest.mark.long
def test_the_film_brakes_the_disk_and_its_table_tells_the_force() -> None:
    braked, free = turning(), turning(sliding=False)
    assert braked.bodies["w"][-1] < 0.95 * free.bodies["w"][-1]
    assert braked.energy["contact_loss"][-1] > 5.0 * free.energy["contact_loss"][-1]
    at_end = braked.contacts["time"] == braked.contacts["time"][-1]
    assert braked.contacts["fx"][at_end].sum() == pytest.approx(braked.bodies["cfx"][-1], rel=0.1)
    assert braked.bodies["ct"][-1] < 0.0
