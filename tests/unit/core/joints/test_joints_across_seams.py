"""Joined bodies in a fluid cross periodic surfaces as they move elsewhere."""

from __future__ import annotations

import numpy as np

import rigidfluid
from rigidfluid.api import scene_from_dict

LENGTH = 2.0


def pair(ahead: float) -> rigidfluid.Scene:
    """Two disks that a hinge joins, in the sheared part of a flow; all are ``ahead`` of places before the seam."""
    disk = {"type": "sphere", "radius": 0.1, "density": 1.5, "velocity": [0.8, 0.0]}
    places = [[(1.5 + ahead) % LENGTH, 0.35], [(1.75 + ahead) % LENGTH, 0.4]]
    return scene_from_dict(
        {
            "scene": {"name": "pair", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 0.1, "initial": ["4*y*(1 - y)", "0"]},
            "domain": {"lower": [0.0, 0.0], "upper": [LENGTH, 1.0]},
            "boundary": [
                {"on": "left", "type": "periodic", "pressure_drop": 1.6},
                {"on": "right", "type": "periodic"},
            ],
            "body": [disk | {"name": name, "position": place} for name, place in zip("ab", places, strict=True)],
            "joint": [{"name": "hinge", "type": "hinge", "between": ["a", "b"], "at": [places[0][0] + 0.125, 0.375]}],
            "mesh": {"size": 0.15, "size_body": 0.04},
            "time": {"end": 0.6, "step": 0.03},
            "output": {"every": 0.6},
        }
    )


def test_joined_bodies_cross_a_seam_as_they_move_elsewhere() -> None:
    """The joint is on both sides of it at times: motions, angle and force are those of half a period away."""
    here, away = (rigidfluid.run(pair(ahead)) for ahead in (0.0, 1.0))
    first, second = (here.bodies["x"][here.bodies["body"] == name] for name in "ab")
    assert ((first < LENGTH) & (second > LENGTH)).sum() > 3
    assert first[-1] > LENGTH - 0.1
    assert np.ptp(here.bodies["angle"]) > 0.1
    for name, allowed in (("y", 2e-4), ("angle", 5e-4), ("vx", 2e-3), ("vy", 2e-3), ("w", 0.02)):
        np.testing.assert_allclose(here.bodies[name], away.bodies[name], atol=allowed, err_msg=name)
    settled = here.joints["time"] > 0.3
    for name in ("angle", "fx", "fy"):
        np.testing.assert_allclose(here.joints[name][settled], away.joints[name][settled], atol=5e-4, err_msg=name)
    assert here.joints["gap"].max() < 1e-12
