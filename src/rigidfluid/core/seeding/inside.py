"""The inside of a closed surface, that of a body's shape, as a region."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model.body import Body


class Inside:
    """The inside of a ``shape`` in the frame that its options are in."""

    def __init__(self, shape: Body) -> None:
        self._shape, self._wall = shape, _FromInside(shape)

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around it, (d,) each [length]."""
        return self._wall.bounds

    @property
    def volume(self) -> float:
        """[length^d]."""
        return self._shape.volume

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The surface."""
        return (self._wall,)

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are inside, (N,)."""
        return np.asarray(self._wall.signed_distance(points) >= 0.0)


class _FromInside(Surface):
    """The surface of a shape, with distances > 0 and normals inside."""

    def __init__(self, shape: Body) -> None:
        self._shape, self._centre = shape, shape.given_centre

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(d,) each [length]."""
        lower, upper = self._shape.bounds
        return lower + self._centre, upper + self._centre

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """(N,) for ``points`` (N, d) [length]."""
        return -self._shape.signed_distance(points - self._centre)

    def closest_point(self, points: FloatArray) -> FloatArray:
        """(N, d) for ``points`` (N, d) [length]."""
        return np.asarray(self._centre + self._shape.closest_point(points - self._centre))

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals inwards (N, d) at the closest points of ``points`` (N, d)."""
        return -self._shape.normal(points - self._centre)
