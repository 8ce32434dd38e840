"""Mechanisms between periodic surfaces of a fluid, whose parts may be in different images on the mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import rigidfluid
from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.geometry.arrays import FloatArray

LENGTH = 60.0


def swimmer(x: float, end: float = 1.0) -> rigidfluid.Scene:
    """A swimmer as long as 20 radii in a flow along a channel of 60."""
    return scene_from_dict(
        {
            "scene": {"name": "swimmer", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 1.0, "model": "stokes"},
            "domain": {"lower": [0.0, 0.0], "upper": [LENGTH, 40.0]},
            "boundary": [
                {"on": "left", "type": "periodic", "pressure_drop": 3.0},
                {"on": "right", "type": "periodic"},
            ],
            "mechanism": [
                {
                    "name": "swimmer",
                    "type": "three_sphere_swimmer",
                    "radius": 1.0,
                    "arms": 10.0,
                    "amplitude": 4.0,
                    "speed": 4.0,
                    "density": 1.1,
                    "position": [x, 17.0],
                    "angle": 0.3,
                }
            ],
            "mesh": {"size": 8.0, "size_body": 0.6},
            "time": {"end": end, "step": 0.1},
            "output": {"every": 0.5},
        }
    )


def displaced(history: rigidfluid.History) -> FloatArray:
    rows = history.bodies["body"] == "swimmer"
    path = np.array([history.bodies[name][rows] for name in ("x", "y", "angle")])
    return path - path[:, :1]


def test_a_swimmer_whose_parts_are_in_two_images_moves_as_in_the_middle() -> None:
    here = Simulation(swimmer(0.0))
    assert here.state.mesh.periods is not None
    assert here.state.mesh.periods.winding.ravel().tolist() == [-1, 0, 0]
    here.go(1.0)
    middle = displaced(rigidfluid.run(swimmer(30.0)))
    assert middle[0, -1] > 1.0
    np.testing.assert_allclose(displaced(here.history), middle, atol=1e-3 * middle[0, -1])


def test_it_crosses_the_seam_and_is_resumed_to_the_last_bit(tmp_path: Path) -> None:
    whole = rigidfluid.run(swimmer(49.7), tmp_path / "whole")
    right = whole.bodies["x"][whole.bodies["body"] == "swimmer.right"]
    assert right[0] < LENGTH < right[-1]
    assert whole.summary["energy"]["created"] < 1e-3
    rigidfluid.run(swimmer(49.7, end=0.5), tmp_path / "parts")
    parts = rigidfluid.run(swimmer(49.7), tmp_path / "parts", resume=True)
    for name, column in whole.bodies.items():
        np.testing.assert_array_equal(parts.bodies[name], column)
