"""Wishes of a user for a new scene; the command line knows them at its start, so nothing heavy is imported."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args, get_origin, get_type_hints

from rigidfluid.start.scene_text import UNITS

Shape = Literal["sphere", "ellipsoid", "polygon"]
Fluid = Literal["water", "oil", "glycerine", "none"]
Units = Literal["cm", "m", "mm"]


@dataclass(frozen=True)
class Wishes:
    """Wishes of a user: bodies of a ``shape`` in a box of a ``size`` [length], None: 2 cm wide; in a ``fluid``, with
    ``gravity`` downwards [length/time²], None: that of the Earth."""

    dimension: Literal[2, 3] = 2
    bodies: int = 1
    shape: Shape = "sphere"
    size: float | None = None
    fluid: Fluid = "oil"
    gravity: float | None = None
    units: Units = "cm"

    @property
    def width(self) -> float:
        """Width of the box [length]."""
        return 0.02 / UNITS[self.units][2] if self.size is None else self.size


CHOICES = {
    key: [str(choice) for choice in get_args(kind)]
    for key, kind in get_type_hints(Wishes).items()
    if get_origin(kind) is Literal
}
"""Choices for each wish that has some, by its name."""
