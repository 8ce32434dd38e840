"""The round container of docs/plugins.md, from the page itself, and scenes in it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.domain import Domain

PAGE = Path(__file__).parents[2] / "docs" / "plugins.md"
SECTION = PAGE.read_text(encoding="utf-8").partition("\n## A domain, from nothing\n")[2].partition("\n## ")[0]
CODE, TEST = re.findall(r"```python\n(.*?)```", SECTION, flags=re.DOTALL)


def dish(radius: float = 1.0, dimension: int = 2) -> Domain:
    """The domain that the page tells how to write."""
    names: dict[str, Any] = {"__name__": "rigidfluid_dish"}
    exec(CODE, names)
    made: Domain = names["Dish"](names["DishOptions"](radius=radius), dimension)
    return made


def rim(bodies: int, radius: float = 1.0, dimension: int = 2) -> Wall:
    """Its only wall, around so many bodies."""
    (piece,) = dish(radius, dimension).pieces
    return Wall(bodies, piece.name, piece.shape)


def in_a_dish(*bodies: dict[str, Any], dimension: int = 2, **tables: Any) -> dict[str, Any]:
    """A scene in a dish of radius 1; the plug-in has to be installed."""
    scene = {
        "scene": {"name": "dish", "dimension": dimension},
        "fluid": {"density": 1.0, "viscosity": 0.05, "gravity": [0.0, -10.0, 0.0][:dimension]},
        "domain": {"type": "dish", "radius": 1.0},
        "body": list(bodies),
        "contact": {"law": "contact", "range": 0.05, "epsilon": "auto"},
        "mesh": {"size": 0.2, "size_body": 0.06},
        "time": {"end": 2.5, "step": 0.01},
        "output": {"every": 2.5},
    }
    return {**scene, **tables}


def inside(points: np.ndarray, radius: float) -> bool:
    """Whether balls of this radius at all ``points`` (N, d) are within the dish."""
    return bool(np.all(np.linalg.norm(points, axis=-1) + radius < 1.0))
