"""A shape with all its lengths multiplied by a factor."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions


class _ScaledOptions(PartOptions):
    """A shape's options as text, and the factor: equal shapes have equal ones."""

    shape: str
    factor: float


class ScaledBody(Body):
    """A ``shape`` with its lengths multiplied by a ``factor``: x is inside if x/factor is inside the shape."""

    def __init__(self, shape: Body, factor: float) -> None:
        self.name = shape.name  # type: ignore[misc]
        super().__init__(_ScaledOptions(shape=shape.options.model_dump_json(), factor=factor), shape.dimension)
        self._shape, self._factor = shape, factor

    @property
    def volume(self) -> float:
        """[length^d]."""
        return self._factor**self.dimension * self._shape.volume

    @property
    def unit_inertia(self) -> FloatArray:
        """(k, k) [length²]."""
        return self._factor**2 * self._shape.unit_inertia

    @property
    def bounding_radius(self) -> float:
        """[length]."""
        return self._factor * self._shape.bounding_radius

    @property
    def radius(self) -> float | None:
        """The radius if the shape is a ball, else None [length]."""
        return None if self._shape.radius is None else self._factor * self._shape.radius

    @property
    def semi_axes(self) -> FloatArray | None:
        """Semi-axes (d,) of an ellipsoid or a ball, else None [length]."""
        return None if self._shape.semi_axes is None else self._factor * self._shape.semi_axes

    @cached_property
    def _facets(self) -> Facets | None:
        own = self._shape.facets
        return None if own is None else Facets(self._factor * own.points, own.vertices, own.markers)

    @property
    def facets(self) -> Facets | None:
        """The facets that the shape is made of, None of a smooth one."""
        return self._facets

    def closest_point(self, points: FloatArray) -> FloatArray:
        """(N, d) for ``points`` (N, d) [length]."""
        return np.asarray(self._factor * self._shape.closest_point(points / self._factor))

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """(N,) for ``points`` (N, d) [length]."""
        return np.asarray(self._factor * self._shape.signed_distance(points / self._factor))

    def normal(self, points: FloatArray) -> FloatArray:
        """Unit normals (N, d) at the closest points of ``points`` (N, d)."""
        return self._shape.normal(points / self._factor)

    def sample_surface(self, count: int) -> FloatArray:
        """About ``count`` points spread over the surface [length]."""
        return np.asarray(self._factor * self._shape.sample_surface(count))
