"""Abstract class of a body type."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar

import numpy as np

from rigidfluid.core.geometry.answers import anything, number, optional, rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.model import part_answers as parts
from rigidfluid.core.model.part import SpatialPart


class Body(Surface, SpatialPart):
    """A rigid shape in its own frame, its centre of mass at the origin.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[[body]]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "body"

    @property
    @abstractmethod
    @gives(number(0.0))
    def volume(self) -> float:
        """Exact volume of the shape (area in 2D) [length^d]."""

    @property
    @abstractmethod
    @gives(parts.inertia)
    def unit_inertia(self) -> FloatArray:
        """Inertia over mass, ∫(|r|² I - r rᵀ) / volume, shape (k, k) [length²]."""

    @property
    @abstractmethod
    @gives(number(0.0))
    def bounding_radius(self) -> float:
        """Radius of the smallest ball about the origin that holds the shape [length]."""

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the cube around the ball of the bounding radius, (d,) each [length]."""
        corner = np.full(self.dimension, self.bounding_radius)
        return -corner, corner

    @property
    @gives(optional(number(0.0)))
    def radius(self) -> float | None:
        """The radius if the shape is a ball, else None [length]."""
        return None

    @property
    @gives(optional(rows(lambda part: (part.dimension,), positive=True)))
    def semi_axes(self) -> FloatArray | None:
        """Semi-axes (d,) along the axes of its frame if the shape is an ellipsoid or a ball, else None [length]."""
        return None if self.radius is None else np.full(self.dimension, self.radius)

    @abstractmethod
    @gives(parts.points)
    def sample_surface(self, count: int) -> FloatArray:
        """Points spread over the surface, about ``count`` of them, (N, d) [length]."""

    @gives(anything)
    def cad_shape(self, unit: float) -> Any:
        """The shape as a ``netgen.occ`` face (2D) or solid (3D), all its lengths over ``unit``, for the mesh generator;
        None with `facets`."""
        return None

    @property
    @gives(optional(parts.facets))
    def facets(self) -> Facets | None:
        """The facets that the shape is made of, in its own frame; None of a smooth one, which has a `cad_shape`."""
        return None

    @property
    @gives(rows(lambda part: (part.dimension,)))
    def given_centre(self) -> FloatArray:
        """Centre of mass in the frame that the options are in, (d,) [length]."""
        return np.zeros(self.dimension)
