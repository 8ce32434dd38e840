"""A dumb-bell in shear, in boxes of several sizes: the scene `dumbbell_in_shear` and what is measured of it."""

from __future__ import annotations

import tomllib
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np

from rigidfluid.api import Simulation, scene_from_dict
from rigidfluid.core.output.history import History

SCENE = Path(__file__).parents[2] / "scenes" / "dumbbell_in_shear.toml"
_MOMENT, _INERTIA = 1e-4, 1e-8


def tables_of(half: float, distance: float = 3.0, angle: float = 0.0) -> dict[str, Any]:
    """The scene's tables with a box of ±``half``, centres at a ``distance`` [radius], and an ``angle`` to the flow."""
    tables = tomllib.loads(SCENE.read_text(encoding="utf-8"))
    tables["domain"] = {"lower": [-half] * 3, "upper": [half] * 3}
    for wall, speed in zip(tables["boundary"], (half, -half), strict=False):
        wall["velocity"] = [speed, 0.0, 0.0]
    dumbbell = tables["mechanism"][0]
    dumbbell["orientation"] = [cos(angle / 2), 0.0, 0.0, sin(angle / 2)]
    for component, side in zip(dumbbell["component"], (-1.0, 1.0), strict=True):
        component["position"] = [0.5 * side * distance, 0.0, 0.0]
    return tables


def rate(half: float, distance: float, angle: float, size_body: float = 0.4) -> tuple[float, int]:
    """Angular velocity at this angle [shear rate], and the mesh's vertices: after a moment, with next to no inertia."""
    tables = tables_of(half, distance, angle)
    tables["fluid"]["density"] = _INERTIA
    for component in tables["mechanism"][0]["component"]:
        component["density"] = _INERTIA
    tables["mesh"] |= {"size_body": size_body, "size": 0.4 * half}
    tables |= {"time": {"end": _MOMENT, "step": _MOMENT}, "output": {"every": _MOMENT}}
    it = Simulation(scene_from_dict(tables))
    it.go()
    assert it.state.mesh is not None
    return float(it.bodies["dumbbell"].angular_velocity[2]), len(it.state.mesh.points)


def rates(half: float, distance: float, size_body: float = 0.4) -> tuple[float, float]:
    """A and B of dφ/dt = -(A sin²φ + B cos²φ): across the flow and along it [shear rate]."""
    across, along = (-rate(half, distance, angle, size_body)[0] for angle in (pi / 2, 0.0))
    return across, along


def without_box(halves: tuple[float, float], values: tuple[float, float]) -> float:
    """What two boxes say of none: the effect of walls goes with the inverse cube of their distance."""
    weights = np.array(halves) ** 3
    return float((weights @ [-values[0], values[1]]) / (weights[1] - weights[0]))


def angles(history: History) -> np.ndarray:
    """Time and angle from the flow, unbroken, after each step, (steps, 2)."""
    bodies = history.bodies
    left, right = (bodies["body"] == f"dumbbell.{side}" for side in ("left", "right"))
    angle = np.arctan2(*(bodies[name][right] - bodies[name][left] for name in ("y", "x")))
    return np.column_stack([bodies["time"][left], np.unwrap(angle)])[1:]


def time_of(angle: float, turned: np.ndarray) -> float:
    """When it is at an angle, by a cubic spline through the rows of `angles`."""
    from scipy.interpolate import CubicSpline

    return float(CubicSpline(-turned[:, 1], turned[:, 0])(-angle))
