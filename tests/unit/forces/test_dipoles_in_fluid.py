"""Two dipoles in a fluid: they attract each other and turn, and the account of energy closes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History

ALLOWED = 0.005


@cache
def attracted(dimension: int, step: float, model: str = "navier-stokes", distance: float = 0.36) -> History:
    """Two balls, moments of one along their line of centres and of the other at 45° to it, and a law of contact."""
    rest, radius = [0.0] * (dimension - 2), 0.1
    places = [[0.5 + sign * 0.5 * distance, 0.4, *(0.4 for _ in rest)] for sign in (1.0, -1.0)]
    bodies = [{"type": "sphere", "radius": radius, "density": 2.0, "position": place} for place in places]
    moments = [[np.sqrt(0.5), np.sqrt(0.5), *rest], [1.0, 0.0, *rest]]
    force = {"law": "dipole", "range": 2.0, "strength": 2e-4, "names": ["a", "b"], "moments": moments}
    return rigidfluid.run(
        scene_from_dict(
            {
                "scene": {"name": "dipoles", "dimension": dimension},
                "fluid": {"density": 1.0, "viscosity": 0.02, "model": model},
                "domain": {"lower": [0.0] * dimension, "upper": [1.0, *[0.8] * (dimension - 1)]},
                "body": [body | {"name": name} for body, name in zip(bodies, "ab", strict=True)],
                "interaction": [force, {"law": "normal", "range": 0.03, "epsilon": 1e-4}],
                "mesh": {"size": 0.2, "size_body": 0.06 if dimension == 2 else 0.1, "refinements": 0},
                "time": {"end": 0.08, "step": step},
                "output": {"every": 0.08},
            }
        )
    )


def assert_keeps_its_account(history: History) -> None:
    """Of the energy that the dipoles give."""
    energy = history.energy
    given = energy["contact"][0] - energy["contact"][-1]
    assert given > 0.02 * abs(energy["contact"][0])
    assert np.abs(energy["residual"]).max() < ALLOWED * abs(energy["contact"][0])
    assert history.summary["energy"]["largest_creation"] < ALLOWED * abs(energy["contact"][0])


@pytest.mark.parametrize(
    ("dimension", "model"),
    [(2, "navier-stokes"), pytest.param(3, "navier-stokes", marks=pytest.mark.long), (2, "stokes")],
)
def test_they_approach_and_turn_and_no_energy_is_made(dimension: int, model: str) -> None:
    history = attracted(dimension, 4e-3, model)
    assert_keeps_its_account(history)
    x, spin = history.bodies["x"], history.bodies["w" if dimension == 2 else "wz"]
    assert x[-2] - x[-1] < x[0] - x[1]
    assert spin[-2] < 0.0
    both = history.bodies["vx"][-2:].sum()
    assert abs(both) < 0.05 * np.abs(history.bodies["vx"][-2:]).max()


@pytest.mark.parametrize("distance", [0.36, 0.222])
def test_shorter_steps_change_little(distance: float) -> None:
    """Apart, and in contact, where bodies follow substeps."""
    one, other = (attracted(2, step, distance=distance) for step in (4e-3, 2e-3))
    for name in ("x", "angle"):
        moved = other.bodies[name][-2:] - other.bodies[name][:2]
        np.testing.assert_allclose(one.bodies[name][-2:], other.bodies[name][-2:], atol=0.02 * np.abs(moved).max())
