"""Scenes in channels with obstacles, and with a throat."""

from __future__ import annotations

from typing import Any

CHANNEL = {"type": "channel", "lower": [0.0, 0.0], "upper": [4.0, 1.0]}
PIN = {"type": "sphere", "radius": 0.2, "position": [2.0, 0.4], "name": "pin"}
THROAT = {"type": "stenosis", "length": 32.0, "width": 8.0, "radius": 3.125}


def scene(domain: dict[str, Any], **tables: Any) -> dict[str, Any]:
    found = {
        "scene": {"name": "channel", "dimension": 2},
        "fluid": {"density": 1.0, "viscosity": 0.1},
        "domain": domain,
        "body": [{"type": "sphere", "radius": 0.1, "density": 2.0, "position": [1.0, 0.5]}],
        "mesh": {"size": 0.2, "size_body": 0.05},
        "time": {"end": 1.0, "step": 0.1},
        "output": {"every": 1.0},
    }
    return found | tables
