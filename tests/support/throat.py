"""A channel with a round throat, whose curved walls may let fluid slip."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.scene.scene import Scene

SLIPPERY = [
    {"on": "all", "type": "slip"},
    {"on": "left", "type": "pressure", "pressure": 10.0},
    {"on": "right", "type": "pressure", "pressure": 0.0},
]


def throat(boundary: list[dict[str, Any]], end: float = 1.2, step: float = 0.04) -> Scene:
    """A disk that pressure takes through the throat of a channel with round bumps."""
    return scene_from_dict(
        {
            "scene": {"name": "throat", "dimension": 2},
            "domain": {"type": "stenosis", "length": 6.0, "width": 3.0, "radius": 0.8},
            "fluid": {"density": 1.0, "viscosity": 0.1},
            "body": [{"type": "sphere", "radius": 0.3, "density": 1.5, "position": [-1.2, 0.1]}],
            "contact": {},
            "boundary": boundary,
            "mesh": {"size": 0.4, "size_body": 0.12},
            "time": {"end": end, "step": step},
            "output": {"every": 0.4},
        }
    )
