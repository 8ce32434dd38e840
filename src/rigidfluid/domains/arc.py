"""A bump on a flat wall: the part of a disk above the wall."""

from __future__ import annotations

from math import acos, sqrt

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane, Surface


class Arc(Surface):
    """{x : |x - c| = R, above the wall}, with the fluid outside the circle.

    The ``centre`` c (2,) is less than the ``radius`` R from the ``wall``, above or below it [length].
    """

    def __init__(self, centre: FloatArray, radius: float, wall: Plane) -> None:
        self.centre, self._radius, self._wall = centre, radius, wall
        self._above = float(wall.signed_distance(centre[None])[0])
        along = np.array([-wall.unit_normal[1], wall.unit_normal[0]])
        self._ends = wall.closest_point(centre[None]) + np.outer([-self.half_width, self.half_width], along)

    @property
    def radius(self) -> float:
        """R [length]."""
        return self._radius

    @property
    def half_width(self) -> float:
        """Half width of the bump on the wall [length]."""
        return sqrt(self._radius**2 - self._above**2)

    @property
    def length(self) -> float:
        """2Rα, α being half of its angle [length]."""
        return 2.0 * self._radius * self._half_angle

    @property
    def area(self) -> float:
        """Area of the circular segment between arc and wall, R²(α - sin α cos α) [length²]."""
        return self._radius**2 * self._half_angle + self.half_width * self._above

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the rectangle around the arc, (2,) each [length]."""
        extremes = self.centre + self._radius * np.vstack([np.eye(2), -np.eye(2)])
        corners = np.vstack([self._ends, extremes[self._wall.signed_distance(extremes) >= 0.0]])
        return corners.min(axis=0), corners.max(axis=0)

    def closest_point(self, points: FloatArray) -> FloatArray:
        """Points where lines to the centre meet the arc, else the nearer end of the arc, (N, 2) [length]."""
        away = points - self.centre
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        direction = np.where(distance > 0.0, away / np.maximum(distance, 1e-300), self._wall.unit_normal)
        foot = self.centre + self._radius * direction
        nearer = np.argmin(np.linalg.norm(points[:, None] - self._ends, axis=2), axis=1)
        below = self._wall.signed_distance(foot) < 0.0
        return np.where(below[:, None], self._ends[nearer], foot)

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """|x - closest point|, negative within the circle, (N,) [length]."""
        outside = np.linalg.norm(points - self.centre, axis=1) > self._radius
        distance = np.linalg.norm(points - self.closest_point(points), axis=1)
        return np.asarray(np.where(outside, distance, -distance))

    def normal(self, points: FloatArray) -> FloatArray:
        """(x - c)/R of the closest points x, (N, 2)."""
        return np.asarray((self.closest_point(points) - self.centre) / self._radius)

    @property
    def _half_angle(self) -> float:
        return acos(-self._above / self._radius)
