"""A flat plate with round edges."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any, ClassVar, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.api import Body, FloatArray, PartOptions, SceneError


class PlateOptions(PartOptions):
    """Keys of a `[[body]]` table of type `plate`; it lies along the first axis of its frame, and in 3D the third."""

    length: float = Field(gt=0, description="Length along the first axis, with the round edges [length]")
    thickness: float = Field(gt=0, description="Thickness, along the second axis [length]")
    width: float | None = Field(
        default=None, gt=0, description="Width along the third axis, with the round edges; 3D only [length]"
    )

    @model_validator(mode="after")
    def _is_flat(self) -> PlateOptions:
        for name, side in (("length", self.length), ("width", self.width)):
            if side is not None and side <= self.thickness:
                raise ValueError(f"{name} = {side:g} must be above the thickness, {self.thickness:g}")
        return self


class Share(NamedTuple):
    """A part of a plate: its ``volume`` [length^d], and the mean of x² over it along each axis [length²]."""

    volume: float
    squares: Sequence[float]


class Plate(Body):
    """All points nearer than half the thickness to a segment of a line (2D: a stadium) or a rectangle (3D).

    Parameters
    ----------
    options : PlateOptions
        ``length``, ``thickness`` and, in 3D, ``width`` [length].
    dimension : int
        2 or 3.

    Raises
    ------
    SceneError
        With a width in 2D, or without one in 3D.
    """

    name: ClassVar[str] = "plate"
    Options: ClassVar[type[PartOptions]] = PlateOptions
    options: PlateOptions

    def __init__(self, options: PlateOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        if (options.width is None) == (dimension == 3):
            allowed, remedy = ("a length", "Give the width.") if dimension == 3 else ("none in 2D", "Leave it out.")
            raise SceneError("body.width", options.width, allowed, remedy)
        self._radius = 0.5 * options.thickness
        across = 0.0 if options.width is None else 0.5 * options.width - self._radius
        self._reach = np.array([0.5 * options.length - self._radius, 0.0, across])[:dimension]

    @property
    def volume(self) -> float:
        """Of the flat part, the half cylinders of the edges and the quarter balls of the corners [length^d]."""
        return sum(share.volume for share in self._shares())

    @property
    def unit_inertia(self) -> FloatArray:
        """From ∫x² over the same parts, (1, 1) or (3, 3) [length²]."""
        squares = sum(share.volume * np.array(share.squares) for share in self._shares()) / self.volume
        about = np.sum(squares) - squares
        return np.array([[np.sum(squares)]]) if self.dimension == 2 else np.diag(about)

    def _shares(self) -> list[Share]:
        """The flat part and the edges; in 3D these are along both sides, and there are corners.

        Halves of a disk whose straight sides are parted to ±a have the mean square a² + 2a·4r/(3π) + r²/4 across them,
        quarters of a ball a² + 2a·3r/8 + r²/5.
        """
        a, r = self._reach[0], self._radius
        if self.dimension == 2:
            return [Share(4 * a * r, (a**2 / 3, r**2 / 3)), Share(pi * r**2, (_ends(a, r), r**2 / 4))]
        b = self._reach[2]
        return [
            Share(8 * a * b * r, (a**2 / 3, r**2 / 3, b**2 / 3)),
            Share(2 * b * pi * r**2, (_ends(a, r), r**2 / 4, b**2 / 3)),
            Share(2 * a * pi * r**2, (a**2 / 3, r**2 / 4, _ends(b, r))),
            Share(4 / 3 * pi * r**3, (_corners(a, r), r**2 / 5, _corners(b, r))),
        ]

    @property
    def bounding_radius(self) -> float:
        """To the ends, or the corners [length]."""
        return float(np.linalg.norm(self._reach)) + self._radius

    @property
    def least_radius(self) -> float:
        """Of the edges, half the thickness [length]."""
        return self._radius

    def _from_middle(self, points: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Nearest points of the segment or rectangle in the middle, and the vectors and distances from there."""
        foot = np.clip(points, -self._reach, self._reach)
        away = points - foot
        return foot, away, np.linalg.norm(away, axis=1)

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points (N, d) of the surface for ``points`` (N, d); of the middle, points above it [length]."""
        foot, away, distance = self._from_middle(points)
        inside = distance == 0
        unit = np.where(inside[:, None], np.eye(self.dimension)[1], away / np.where(inside, 1.0, distance)[:, None])
        return np.asarray(foot + self._radius * unit)

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to the middle less half the thickness, (N,) for ``points`` (N, d) [length]."""
        return np.asarray(self._from_middle(points)[2] - self._radius)

    def sample_surface(self, count: int) -> FloatArray:
        """``count`` points of the surface, dense at the edges, (count, d) [length]."""
        index = np.arange(count)
        angle = 2 * pi * index / count if self.dimension == 2 else index * pi * (3 - np.sqrt(5))
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        if self.dimension == 3:
            height = 1 - (2 * index + 1) / count
            ring = np.column_stack([ring * np.sqrt(1 - height**2)[:, None], height])
        return self.closest_point(self.bounding_radius * ring)

    def cad_shape(self, unit: float) -> Any:
        """A ``netgen.occ`` face (2D) or solid (3D) with lengths over ``unit``."""
        from netgen import occ

        a, r = float(self._reach[0]) / unit, self._radius / unit
        if self.dimension == 2:
            return occ.WorkPlane().MoveTo(-a, -r).Line(2 * a).Arc(r, 180).Line(2 * a).Arc(r, 180).Face()
        b = float(self._reach[2]) / unit
        shape = occ.Box(occ.Pnt(-a, -r, -b), occ.Pnt(a, r, b))
        for side in (-1, 1):
            shape += occ.Cylinder(occ.Pnt(side * a, 0, -b), occ.Z, r, 2 * b)
            shape += occ.Cylinder(occ.Pnt(-a, 0, side * b), occ.X, r, 2 * a)
            shape += occ.Sphere(occ.Pnt(-a, 0, side * b), r) + occ.Sphere(occ.Pnt(a, 0, side * b), r)
        return shape


def _ends(a: float, r: float) -> float:
    return a**2 + 8 * a * r / (3 * pi) + r**2 / 4


def _corners(a: float, r: float) -> float:
    return a**2 + 3 * a * r / 4 + r**2 / 5
