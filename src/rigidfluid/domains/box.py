"""A box with its sides along the axes."""

from __future__ import annotations

from collections.abc import Collection
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError

NAMES = ("left", "right", "bottom", "top", "back", "front")
"""Names of the lower and the upper face along each axis."""


class BoxOptions(PartOptions):
    """Keys of the ``[domain]`` table with type ``box``: ``lower`` and ``upper``, its corners [length].

    Its surfaces are ``left`` and ``right`` along x, ``bottom`` and ``top`` along y, ``back`` and ``front`` along z;
    ``xmin`` and ``xmax``, ``ymin`` and ``ymax``, ``zmin`` and ``zmax`` are other names of these, which results have too
    where a ``[[boundary]]`` or ``[[interaction]]`` table uses them.
    """

    lower: tuple[float, ...] = Field(description="Corner of the box with the smallest coordinates [length]")
    upper: tuple[float, ...] = Field(description="Corner of the box with the largest coordinates [length]")


@dataclass(frozen=True)
class _FaceCoordinates:
    """Map points (N, d) to (x - lower)/(upper - lower) without the component across the face (N, d-1)."""

    lower: FloatArray
    upper: FloatArray
    axis: int

    def __call__(self, points: FloatArray) -> FloatArray:
        return np.delete((points - self.lower) / (self.upper - self.lower), self.axis, axis=1)


class Box(Domain):
    """{x : lower < x < upper}, of volume ∏ (upper - lower).

    Parameters
    ----------
    options : BoxOptions
        ``lower`` and ``upper`` corner [length].
    dimension : int
        2 or 3.

    Raises
    ------
    SceneError
        If the corners have not as many coordinates as there are dimensions, or ``upper`` is not above ``lower``.
    """

    name: ClassVar[str] = "box"
    also_called: ClassVar[tuple[str, ...]] = ("cube", "rectangle", "square")
    Options: ClassVar[type[PartOptions]] = BoxOptions
    options: BoxOptions
    _called: Collection[str] = ()

    def __init__(self, options: BoxOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        for key, corner in (("lower", options.lower), ("upper", options.upper)):
            if len(corner) != dimension:
                found, remedy = f"{list(corner)}, {len(corner)} of them", f"The scene has {dimension} dimensions."
                raise SceneError(f"domain.{key}", found, f"{dimension} numbers", remedy)
        self._lower, self._upper = np.array(options.lower), np.array(options.upper)
        if np.any(self._upper <= self._lower):
            allowed = f"a corner above domain.lower = {list(options.lower)}"
            raise SceneError("domain.upper", list(options.upper), allowed, "Swap or correct them.")

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Two faces for each axis, the lower one first."""
        return tuple(self._face(axis, side) for axis in range(self.dimension) for side in (0, 1))

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """The corners [length]."""
        return self._lower, self._upper

    @property
    def volume(self) -> float:
        """∏ (upper - lower) [length^d]."""
        return float(np.prod(self.size))

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside or on a face, (N,)."""
        return np.asarray(np.all((self._lower <= points) & (points <= self._upper), axis=1))

    def cad_shape(self, unit: float) -> Any:
        """A rectangle in the plane z = 0 (2D) or a cuboid (3D), as ``netgen.occ`` shapes with lengths over ``unit``."""
        from netgen import occ

        lower, upper = (in_unit(corner, unit) for corner in self.extent)
        if self.dimension == 2:
            shape = occ.WorkPlane().Rectangle(*(upper - lower)).Face().Move(occ.Vec(*map(float, lower), 0.0))
            sides = shape.edges
        else:
            shape = occ.Box(occ.Pnt(*lower), occ.Pnt(*upper))
            sides = shape.faces
        for side in sides:
            centre = np.array([side.center.x, side.center.y, side.center.z])[: self.dimension]
            distance = np.abs(np.column_stack([centre - lower, upper - centre]) / (upper - lower)[:, None])
            side.name = self.names[int(np.argmin(distance))]
        return shape

    def called(self, names: Collection[str]) -> Self:
        """The same box with faces called ``xmin`` … ``zmax`` where these are among the ``names``."""
        other = copy(self)
        other._called = names
        vars(other).pop("pieces", None)  # they were kept under other names
        return other

    def between(self, axis: int, lower: float, upper: float) -> Box:
        """The box with these coordinates along an axis instead of its own."""
        low, high = self._lower.tolist(), self._upper.tolist()
        low[axis], high[axis] = lower, upper
        return Box(BoxOptions(lower=tuple(low), upper=tuple(high)), self.dimension).called(self._called)

    def _face(self, axis: int, side: int) -> Piece:
        lower, upper = self._lower.copy(), self._upper.copy()
        lower[axis] = upper[axis] = (self._lower, self._upper)[side][axis]
        normal = np.zeros(self.dimension)
        normal[axis] = 1.0 - 2.0 * side
        name, other_name = NAMES[2 * axis + side], "xyz"[axis] + ("min", "max")[side]
        if other_name in self._called:
            name, other_name = other_name, name
        return Piece(
            name=name,
            other_name=other_name,
            shape=Plane((self._lower, self._upper)[side], normal, (lower, upper)),
            area=float(np.prod(np.delete(self.size, axis))),
            coordinates=_FaceCoordinates(self._lower, self._upper, axis),
        )
