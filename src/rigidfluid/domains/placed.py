"""A body's shape that stays where it is: an obstacle, seen as a surface of the domain."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.geometry.mesher_unit import in_space, in_unit
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.mechanics.frames import to_body_frame, to_world
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mesh.generation.cad_of_body import cad_of_body
from rigidfluid.core.mesh.generation.meshing import sides, turned
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose


class PlacedBody(Surface):
    """The surface {c + R ξ : ξ on the shape} of a body with its centre c and rotation R by ``pose``."""

    def __init__(self, shape: Body, pose: Pose) -> None:
        self.shape, self.pose = shape, pose

    @property
    def radius(self) -> float | None:
        """The radius if the shape is a ball, else None [length]."""
        return self.shape.radius

    @property
    def semi_axes(self) -> FloatArray | None:
        """Semi-axes of the shape, along the axes of its own frame; None if it has none [length]."""
        return self.shape.semi_axes

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Corners of the cube around the ball of the bounding radius, (d,) each [length]."""
        return self.pose.position[0] - self.shape.bounding_radius, self.pose.position[0] + self.shape.bounding_radius

    def closest_point(self, points: FloatArray) -> FloatArray:
        """c + R (the shape's closest point to Rᵀ(x - c)), (N, d), for ``points`` x (N, d) [length]."""
        return to_world(self.pose, 0, self.shape.closest_point(to_body_frame(self.pose, 0, points)))

    def signed_distance(self, points: FloatArray) -> FloatArray:
        """The shape's distance at Rᵀ(x - c), (N,), for ``points`` x (N, d) [length]."""
        return self.shape.signed_distance(to_body_frame(self.pose, 0, points))

    def normal(self, points: FloatArray) -> FloatArray:
        """R (the shape's normal at Rᵀ(x - c)), (N, d), for ``points`` x (N, d)."""
        turn = rotation_matrices(self.pose.orientation)[0]
        return np.asarray(self.shape.normal(to_body_frame(self.pose, 0, points)) @ turn.T)

    @cached_property
    def surface(self) -> Surface:
        """The facets in their place, if the shape is made of some, else this."""
        if self.shape.facets is None:
            return self
        points = to_world(self.pose, 0, self.shape.facets.points)
        return FacetSurface(replace(self.shape.facets, points=points))

    def cad_shape(self, name: str, unit: float) -> Any:
        """The shape in its place as a ``netgen.occ`` face or solid with lengths over ``unit``, its sides called
        ``name``."""
        from netgen import occ

        placed = turned(cad_of_body(self.shape, unit), self.pose.orientation[0])
        placed = placed.Move(occ.Vec(*in_space(in_unit(self.pose.position[0], unit))))
        for side in sides(placed, self.shape.dimension):
            side.name = name
        return placed

    @cached_property
    def area(self) -> float:
        """Length of the outline (2D) or area of the surface [length^(d-1)], of facets their sum.

        8 R_G(0, a², b²) of an ellipse and 4π R_G(a²b², b²c², c²a²) of an ellipsoid, with Carlson's R_G (DLMF 19.30 and
        19.33); of other smooth shapes what Open CASCADE finds, by quadrature.
        """
        if self.semi_axes is not None:
            squares = self.semi_axes**2
            if self.shape.dimension == 2:
                return float(8.0 * scipy.special.elliprg(0.0, *squares))
            return float(4.0 * np.pi * scipy.special.elliprg(*(squares * np.roll(squares, 1))))
        if self.shape.facets is not None:
            areas = area_vectors(self.shape.facets.points, self.shape.facets.vertices)
            return float(np.linalg.norm(areas, axis=1).sum())
        unit, d = self.shape.bounding_radius, self.shape.dimension
        return float(sum(side.mass for side in sides(cad_of_body(self.shape, unit), d))) * unit ** (d - 1)
