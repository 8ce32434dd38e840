"""A boundary between solid and fluid: what bodies' shapes and the walls around the fluid have in common."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.answers import corners, curvature, instance, optional, rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import Guarded, gives

_STEP = 1e-6
"""Step of central differences, over the size of the surface."""

_ALONG_AN_AXIS = 1e-14
"""A unit normal whose other components are below this lies along an axis."""


class Surface(metaclass=Guarded):
    """A closed or open surface between a solid and the fluid.

    Distances are positive in the fluid and normals point into it: out of a body, and into the domain from its boundary.
    A shape known in closed form says so by its `plane`, `radius` or `semi_axes`; the others are None, and whoever asks
    then takes points and distances.
    """

    kind: ClassVar[str] = "surface"

    @abstractmethod
    @gives(rows(lambda _, points: points.shape))
    def closest_point(self, points: FloatArray) -> FloatArray:
        """Nearest points of the surface, (N, d) for ``points`` (N, d) [length]."""

    @abstractmethod
    @gives(rows(lambda _, points: points.shape[:1]))
    def signed_distance(self, points: FloatArray) -> FloatArray:
        """Distance to the surface, (N,), > 0 in the fluid, for ``points`` (N, d) [length]."""

    @property
    @abstractmethod
    @gives(corners)
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper corner of the box around the surface, (d,) each [length]."""

    @property
    @gives(optional(instance(lambda: Plane)))
    def plane(self) -> Plane | None:
        """The plane that the surface lies in if it is flat, else None."""
        return None

    @property
    @gives(optional(curvature))
    def radius(self) -> float | None:
        """Radius of curvature if it is the same everywhere: r > 0 of a ball, r < 0 of a round hollow around the fluid,
        infinite of a plane; else None [length]."""
        return None

    @property
    @gives(optional(rows(lambda part: (len(part.bounds[0]),), positive=True)))
    def semi_axes(self) -> FloatArray | None:
        """Semi-axes (d,) along the axes of its frame if the surface is an ellipsoid's or a ball's, else None
        [length]."""
        return None

    @property
    @gives(optional(curvature))
    def least_radius(self) -> float | None:
        """Smallest radius of curvature |R| where it is known: c²/a of an ellipsoid of longest semi-axis a and shortest
        c, infinite of a plane; else None [length]."""
        if self.radius is not None:
            return abs(self.radius)
        return None if self.semi_axes is None else float(self.semi_axes.min() ** 2 / self.semi_axes.max())

    @gives(rows(lambda _, points: points.shape))
    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals into the fluid, (N, d), at the closest points of ``points`` (N, d).

        They are central differences of the distance, unless a shape knows better.
        """
        foot = self.closest_point(points)
        lower, upper = self.bounds
        steps = _STEP * float(np.max(upper - lower)) * np.eye(points.shape[1])
        slopes = [self.signed_distance(foot + step) - self.signed_distance(foot - step) for step in steps]
        gradient = np.stack(slopes, axis=1)
        return np.asarray(gradient / np.linalg.norm(gradient, axis=1, keepdims=True))


class Plane(Surface):
    """The plane (x - x₀)·n = 0; the fluid is where that is positive.

    Parameters
    ----------
    point : (d,) array
        x₀, any point of the plane [length].
    normal : (d,) array
        n, of length 1, into the fluid [1].
    bounds : pair of (d,) arrays, optional
        Corners of the box around the part of the plane that is meant, if it ends somewhere [length].
    """

    def __init__(
        self, point: FloatArray, normal: FloatArray, bounds: tuple[FloatArray, FloatArray] | None = None
    ) -> None:
        self.point = np.asarray(point, dtype=float)
        self.unit_normal = np.asarray(normal, dtype=float)
        endless = np.full(len(self.point), np.inf)
        self._bounds = (-endless, endless) if bounds is None else bounds
        across = np.flatnonzero(np.abs(self.unit_normal) > _ALONG_AN_AXIS)
        self.axis = int(across[0]) if len(across) == 1 else None
        """The axis that the normal lies along, if any."""

    @property
    def plane(self) -> Plane:
        """The plane itself."""
        return self

    @property
    def radius(self) -> float:
        """Radius of curvature, infinite."""
        return np.inf

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the box around the plane, infinite where it has no end [length]."""
        return self._bounds

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """(x - x₀)·n, (N,), for ``points`` x (N, d) [length]."""
        return np.asarray((points - self.point) @ self.unit_normal)

    def closest_point(self, points: FloatArray) -> FloatArray:
        """x - [(x - x₀)·n] n, (N, d); across an axis exactly with the plane's coordinate [length]."""
        if self.axis is None:
            return np.asarray(points - self.signed_distance(points)[:, None] * self.unit_normal)
        foot = points.copy()
        foot[:, self.axis] = self.point[self.axis]
        return foot

    def normal(self, points: FloatArray) -> FloatArray:
        """n, (N, d), at any of ``points`` (N, d)."""
        return np.tile(self.unit_normal, (len(points), 1))
