"""Profiles of a prescribed velocity over a flat piece of the boundary: factors from 0 on its edges to 1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane

_PANELS = 8
"""Number of panels, of three points each, in which a side is integrated."""

_TERMS = 200
"""Number of terms of a duct's series, which then misses its walls by 1e-6 of the peak."""

_SAME = 1e-9
"""A piece of the size of its bounding rectangle, or of the disk in it, is one, by this relative difference."""


@dataclass(frozen=True)
class Rectangle:
    """A flat piece of ``sides`` (d-1,) about its ``centre`` (d,), along the unit vectors ``along`` (d-1, d); in 2D a
    segment."""

    centre: FloatArray
    sides: FloatArray
    along: FloatArray

    def coordinates(self, points: FloatArray) -> FloatArray:
        """Coordinates of ``points`` (N, d) along each side, from 0 to 1, (N, d-1)."""
        return np.asarray(0.5 + (points - self.centre) @ self.along.T / self.sides)

    def points(self, coordinates: FloatArray) -> FloatArray:
        """The points (N, d) with ``coordinates`` (N, d-1) from 0 to 1 [length]."""
        return np.asarray(self.centre + (coordinates - 0.5) * self.sides @ self.along)

    def quadrature(self) -> tuple[FloatArray, FloatArray]:
        """Points (N, d) and weights (N,) of an integral over it."""
        nodes, weights = _composite_rule()
        grid = np.meshgrid(*[nodes] * len(self.sides), indexing="ij")
        products = np.prod(np.meshgrid(*[weights] * len(self.sides), indexing="ij"), axis=0)
        points = self.points(np.stack([axis.ravel() for axis in grid], axis=1))
        return points, products.ravel() * np.prod(self.sides)


@dataclass(frozen=True)
class Disk:
    """A flat round piece of ``radius`` about its ``centre`` (3,) [length], across its ``normal`` (3,)."""

    centre: FloatArray
    radius: float
    normal: FloatArray

    def quadrature(self) -> tuple[FloatArray, FloatArray]:
        """Points (N, 3) and weights (N,) of an integral over it."""
        nodes, weights = _composite_rule()
        along = np.linalg.svd(self.normal[None, :])[2][1:]
        circle = np.stack([np.cos(2.0 * np.pi * nodes), np.sin(2.0 * np.pi * nodes)], axis=1) @ along
        points = self.centre + self.radius * nodes[:, None, None] * circle
        return points.reshape(-1, 3), 2.0 * np.pi * self.radius**2 * np.outer(weights * nodes, weights).ravel()


def section(piece: Piece) -> Rectangle | Disk | None:
    """Shape of a flat piece, by its area and bounding box: in 2D a segment from the end with the smaller coordinates;
    in 3D a disk, or a rectangle across an axis with sides along the others. None for any other piece."""
    plane = piece.shape.plane
    if plane is None:
        return None
    lower, upper = piece.shape.bounds
    if not np.all(np.isfinite(upper - lower)):
        return None
    centre, size = 0.5 * (lower + upper), upper - lower
    if len(size) == 2:
        return _segment(piece.area, plane, centre, size)
    if plane.axis is not None and np.isclose(np.prod(np.delete(size, plane.axis)), piece.area, rtol=_SAME, atol=0.0):
        return Rectangle(centre, np.delete(size, plane.axis), np.delete(np.eye(3), plane.axis, axis=0))
    radius = float(np.sqrt(piece.area / np.pi))
    round_size = 2.0 * radius * np.sqrt(1.0 - plane.unit_normal**2)
    return Disk(centre, radius, plane.unit_normal) if np.allclose(size, round_size, atol=_SAME * radius) else None


def _composite_rule() -> tuple[FloatArray, FloatArray]:
    """Gauss' rule of three points in each panel of [0, 1], exact for polynomials of degree 5."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    panels = np.arange(_PANELS)[:, None]
    return ((panels + 0.5 * (nodes + 1.0)) / _PANELS).ravel(), np.tile(0.5 * weights / _PANELS, _PANELS)


def _segment(length: float, plane: Plane, centre: FloatArray, size: FloatArray) -> Rectangle | None:
    if not np.isclose(np.linalg.norm(size), length, rtol=_SAME, atol=0.0):
        return None
    along = np.array([-plane.unit_normal[1], plane.unit_normal[0]])
    first = along[np.argmax(np.abs(along) > _SAME)]
    return Rectangle(centre, np.array([length]), np.sign(first) * along[None, :])


def poiseuille(shape: Rectangle | Disk, points: FloatArray) -> FloatArray:
    """Fully developed flow at ``points`` (N, d) of a section over its peak, (N,) from 0 to 1 [1]: the solution of Δu =
    const with u = 0 on its edge.

    2D: 4 s(1 - s); disk: 1 - r²/R²; rectangle |y| ≤ a ≤ b, |z| ≤ b: 1 - (y/a)² less (32/π³) Σ (-1)^((n-1)/2) n⁻³
    cosh(nπz/2a)/cosh(nπb/2a) cos(nπy/2a) over odd n, and all that over its value in the middle. White, Viscous Fluid
    Flow, McGraw-Hill 2006, section 3-3.
    """
    if isinstance(shape, Disk):
        return np.asarray(1.0 - np.sum((points - shape.centre) ** 2, axis=1) / shape.radius**2)
    s = shape.coordinates(points)
    if len(shape.sides) == 1:
        return np.asarray(4.0 * s[:, 0] * (1.0 - s[:, 0]))
    short = int(np.argmin(shape.sides))
    ratio = float(shape.sides[1 - short] / shape.sides[short])
    y, z = 2.0 * s[:, short] - 1.0, (2.0 * s[:, 1 - short] - 1.0) * ratio
    middle = _duct(np.zeros(1), np.zeros(1), ratio)
    return np.asarray(_duct(y, z, ratio) / middle)


def _duct(y: FloatArray, z: FloatArray, ratio: float) -> FloatArray:
    """1 - y² less the series, for |y| ≤ 1 and |z| ≤ ``ratio``, zero on the walls."""
    total = 1.0 - y**2
    for term in range(_TERMS):
        n = 0.5 * np.pi * (2 * term + 1)
        decay = (
            np.exp(n * (np.abs(z) - ratio)) * (1.0 + np.exp(-2.0 * n * np.abs(z))) / (1.0 + np.exp(-2.0 * n * ratio))
        )
        total -= 4.0 * (-1.0) ** term / n**3 * decay * np.cos(n * y)
    return np.where(np.abs(z) < ratio, total, 0.0)


def couette(shape: Rectangle, points: FloatArray) -> FloatArray:
    """Linear from 0 at a segment's first end to 1 at the other, (N,), at ``points`` (N, 2) [1]."""
    return shape.coordinates(points)[:, 0]
