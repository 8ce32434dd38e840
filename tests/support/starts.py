"""Small scenes with one disk in a box 2 by 1, and flows that may begin at once."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene

DISK: dict[str, Any] = {"type": "sphere", "radius": 0.15, "density": 1.0, "position": [0.7, 0.52]}
INFLOW = [
    {"on": "left", "type": "velocity", "velocity": ["4*y*(1 - y)", 0.0]},
    {"on": "right", "type": "pressure", "pressure": 0.0},
]
STREAM = [
    {"on": "left", "type": "velocity", "velocity": [1.0, 0.0]},
    {"on": "right", "type": "pressure", "pressure": 0.0},
    {"on": "top", "type": "slip"},
    {"on": "bottom", "type": "slip"},
]


def disk_in_box(
    step: float, end: float, body: dict[str, Any] | None = None, fluid: dict[str, Any] | None = None, **tables: Any
) -> Scene:
    """The disk, fixed if nothing is said of it, with keys of its ``body``, of ``fluid`` and of other tables."""
    return scene_from_dict(
        {
            "scene": {"name": "starts", "dimension": 2},
            "fluid": {"density": 1.0, "viscosity": 0.01} | (fluid or {}),
            "domain": {"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
            "body": [DISK | ({"fixed": True} if body is None else body)],
            "mesh": {"size": 0.25, "size_body": 0.1},
            "time": {"end": end, "step": step},
            "output": {"every": end},
        }
        | tables
    )
