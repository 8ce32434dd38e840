"""A circular cylinder, or in 2D a disk, as a region."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.surface import Plane, Surface


class Cylinder:
    """All x with |x - c| < ``radius``, c the point of the axis from ``start`` to ``end`` nearest to x; in 2D ``start``
    alone is the axis [length]."""

    def __init__(self, start: FloatArray, end: FloatArray | None, radius: float) -> None:
        self._start, self._radius = start, radius
        axis = np.zeros(len(start)) if end is None else end - start
        self._length = float(np.linalg.norm(axis))
        self._along = axis / self._length if self._length else axis

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around it, (d,) each [length]."""
        ends = np.stack([self._start, self._start + self._length * self._along])
        across = self._radius * np.sqrt(1.0 - self._along**2)
        return ends.min(axis=0) - across, ends.max(axis=0) + across

    @property
    def volume(self) -> float:
        """πa²l, in 2D πa² [length^d]."""
        return pi * self._radius**2 * (self._length if len(self._start) == 3 else 1.0)

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The mantle, and in 3D both ends."""
        return (_Mantle(self._start, self._along, self._radius, self.extent), *self._ends())

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""
        return np.asarray(np.all([surface.signed_distance(points) >= 0.0 for surface in self.surfaces], axis=0))

    def _ends(self) -> Iterator[Surface]:
        if self._length:
            yield Plane(self._start, self._along)
            yield Plane(self._start + self._length * self._along, -self._along)


class _Mantle(Surface):
    """The surface |x - c| = a around an axis, seen from inside."""

    def __init__(
        self, start: FloatArray, along: FloatArray, radius: float, bounds: tuple[FloatArray, FloatArray]
    ) -> None:
        self._start, self._along, self._radius, self._bounds = start, along, radius, bounds

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(d,) each [length]."""
        return self._bounds

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """a - |x - c|, (N,) [length]."""
        return np.asarray(self._radius - np.linalg.norm(self._away(points), axis=1))

    def closest_point(self, points: FloatArray) -> FloatArray:
        """x + (a - |x - c|)(x - c)/|x - c|, (N, d) [length]."""
        return np.asarray(points - self.signed_distance(points)[:, None] * self.normal(points))

    def normal(self, points: FloatArray) -> FloatArray:
        """(c - x)/|x - c|, (N, d); any direction across on the axis itself."""
        away = self._away(points)
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        across = np.eye(len(self._along))[np.argmin(np.abs(self._along))]
        across -= (across @ self._along) * self._along
        across /= np.linalg.norm(across)
        return np.where(distance > 0.0, -away / np.where(distance > 0.0, distance, 1.0), across)

    def _away(self, points: FloatArray) -> FloatArray:
        away = points - self._start
        return np.asarray(away - (away @ self._along)[:, None] * self._along)
