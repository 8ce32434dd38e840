"""Regions of finer cells away from the bodies' surfaces: boxes, capsules and curved walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model.domain import Domain

CELLS_PER_RADIUS = 4.0
"""Number of edges as long together as the least radius of curvature R of a wall; an edge then cuts off R/128 of it."""


class Region(Protocol):
    """Part of the domain with cells of one ``size`` [length]; from there cells grow as they do from a body."""

    @property
    def size(self) -> float:
        """Longest edge wanted inside [length]."""

    def distance(self, points: FloatArray) -> FloatArray:
        """Distance of points (N, d) to the region, (N,), zero inside [length]."""


@dataclass(frozen=True, slots=True)
class RefinedBox:
    """A box along the axes, from ``lower`` to ``upper``, each (d,) [length]."""

    lower: FloatArray
    upper: FloatArray
    size: float

    def distance(self, points: FloatArray) -> FloatArray:
        """|max(lower - x, x - upper, 0)|."""
        outside = np.maximum(np.maximum(self.lower - points, points - self.upper), 0.0)
        return np.asarray(np.linalg.norm(outside, axis=1))


@dataclass(frozen=True, slots=True)
class RefinedCapsule:
    """All within ``radius`` of the segment from ``start`` to ``end``, each (d,) [length]."""

    start: FloatArray
    end: FloatArray
    radius: float
    size: float

    def distance(self, points: FloatArray) -> FloatArray:
        """max(|x - nearest point of the segment| - radius, 0)."""
        along, from_start = self.end - self.start, points - self.start
        share = np.clip(from_start @ along / (along @ along), 0.0, 1.0)
        from_axis: FloatArray = np.linalg.norm(from_start - share[:, None] * along, axis=1)
        return np.maximum(from_axis - self.radius, 0.0)


@dataclass(frozen=True, slots=True)
class CurvedWall:
    """The points of a ``shape`` that is part of the domain's boundary."""

    shape: Surface
    size: float

    def distance(self, points: FloatArray) -> FloatArray:
        """|signed distance|."""
        return np.abs(self.shape.signed_distance(points))


def curved_walls(domain: Domain, size: float, size_wall: float | None) -> tuple[CurvedWall, ...]:
    """Curved pieces of the boundary, in their order, that ask for cells finer than ``size`` [length].

    Edges there are at most ``size_wall`` long [length]; if None, the least radius of curvature over CELLS_PER_RADIUS,
    if that is known.
    """
    found = []
    for shape in (piece.shape for piece in domain.pieces):
        radius = np.inf if shape.least_radius is None else shape.least_radius
        wanted = radius / CELLS_PER_RADIUS if size_wall is None or shape.plane is not None else size_wall
        if wanted < size:
            found.append(CurvedWall(shape, wanted))
    return tuple(found)
