"""Bodies enter and leave a fluid between periodic surfaces, on either side of the seam."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rigidfluid
from rigidfluid.api import scene_from_dict

LENGTH = 2.0


def box(lower: float, upper: float) -> dict[str, object]:
    return {"type": "box", "lower": [lower % LENGTH, 0.2], "upper": [upper % LENGTH, 0.8]}


def stream(ahead: float, end: float = 1.4) -> rigidfluid.Scene:
    """Two grains enter a channel, and leave it further down; all places are ``ahead`` of those on both sides of the
    seam."""
    grain = {"name": "grain", "shape": [{"type": "sphere", "radius": 0.06}], "density": 1.1, "velocity": [1.0, 0.0]}
    post = {"name": "post", "type": "sphere", "radius": 0.08, "density": 1.1, "fixed": True}
    return scene_from_dict(
        {
            "scene": {"name": "stream", "dimension": 2, "seed": 3},
            "fluid": {"density": 1.0, "viscosity": 0.1},
            "domain": {"lower": [0.0, 0.0], "upper": [LENGTH, 1.0]},
            "boundary": [
                {"on": "left", "type": "periodic", "pressure_drop": 2.4},
                {"on": "right", "type": "periodic"},
            ],
            "body": [post | {"position": [(1.35 + ahead) % LENGTH, 0.5]}],
            "source": [grain | {"region": box(1.7 + ahead, 1.95 + ahead), "times": [0.1, 0.4]}],
            "sink": [{"region": box(0.35 + ahead, 0.6 + ahead)}],
            "contact": {"law": "normal", "range": 0.02, "epsilon": "auto"},
            "mesh": {"size": 0.2, "size_body": 0.025},
            "time": {"end": end, "step": 0.04},
            "output": {"every": 0.6},
        }
    )


def test_bodies_enter_and_leave_across_a_seam_as_away_from_it() -> None:
    """Both grains have crossed the seam when the first one leaves: the second goes on as elsewhere."""
    here, away = (rigidfluid.run(stream(ahead)) for ahead in (0.0, 1.0))
    for name in ("grain0", "grain1"):
        (one, two) = (history.bodies["body"] == name for history in (here, away))
        np.testing.assert_array_equal(here.bodies["time"][one], away.bodies["time"][two])
        assert here.bodies["x"][one][-1] > LENGTH
        for column in ("y", "vx", "vy"):
            np.testing.assert_allclose(here.bodies[column][one], away.bodies[column][two], atol=5e-3)
    exchange, other = (history.energy["exchange"][-1] for history in (here, away))
    np.testing.assert_allclose(exchange, other, rtol=0.05)
    for history in (here, away):
        assert abs(history.energy["residual"][-1]) < 1e-3 * history.energy["boundary"][-1]


@pytest.mark.long
def test_it_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    whole = rigidfluid.run(stream(0.0), tmp_path / "whole")
    rigidfluid.run(stream(0.0, end=0.6), tmp_path / "parts")
    parts = rigidfluid.run(stream(0.0), tmp_path / "parts", resume=True)
    for name, column in whole.bodies.items():
        np.testing.assert_array_equal(parts.bodies[name], column)
