"""The cell size that the meshers make where another is wanted: facets of bodies are shorter than allowed, and so are
the cells next to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mechanics.shapes import equal_volume_radius, shape_key
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.regions import CurvedWall
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, reach_of_bodies, size_between
from rigidfluid.core.model.body import Body

_MOST_GROWTH = 0.4
"""Growth of the size with the distance that MMG's ratio of 1.3 between neighbouring edges comes to, fitted."""

_GROWTH_FROM_FACETS = float(np.log(2.3))
"""MMG lets edges grow by the ratio of 2.3 from those that it must keep."""

_MEAN_OVER_LONGEST = {2: 0.9, 3: 0.66}
"""Mean edge of Netgen's facets where the longest edge is limited."""

_EDGES_PER_RADIUS = 2.0
"""Netgen makes edges no longer than the radius of curvature over this."""


def made_size(points: FloatArray, fluid_domain: FluidDomain, sizes: Sizes) -> tuple[FloatArray, FloatArray]:
    """Edge length of cells to be expected at points, min(h, eᵢ + 0.83 dᵢ) over the bodies i, (N,) [length].

    h is the `wanted_size`, its growth at most 0.4; eᵢ is the mean edge of the body's facets, and dᵢ its distance.
    Curved walls count as bodies do. With it comes the distance to the nearest body, negative inside, infinite where
    it is so far that it decides nothing, (N,) [length].
    """
    bodies, pose = fluid_domain.bodies, fluid_domain.pose
    sizes = replace(sizes, growth=min(sizes.growth, _MOST_GROWTH))
    first, second, kept = np.full((3, len(points)), np.inf)
    shapes = {shape_key(body): body for body in bodies}
    edge = {key: facet_edge(body, sizes.size_body) for key, body in shapes.items()}
    reach = max(reach_of_bodies(sizes), sizes.size / _GROWTH_FROM_FACETS)
    for i, body in enumerate(bodies):
        least = np.linalg.norm(points - pose.position[i], axis=1) - body.bounding_radius
        decides = (least < second) | (edge[shape_key(body)] + _GROWTH_FROM_FACETS * least < kept)
        near = np.flatnonzero((least < reach) & decides)
        distance = distance_to_body(pose, i, body, points[near])
        second[near] = np.minimum(second[near], np.maximum(first[near], distance))
        first[near] = np.minimum(first[near], distance)
        allowed = edge[shape_key(body)] + _GROWTH_FROM_FACETS * np.maximum(distance, 0.0)
        kept[near] = np.minimum(kept[near], allowed)
    size = size_between(points, np.maximum(first, 0.0), np.maximum(second, 0.0), fluid_domain, sizes)
    np.minimum(size, kept, out=size)
    for region in sizes.regions:
        if isinstance(region, CurvedWall):
            at_wall = _MEAN_OVER_LONGEST[points.shape[1]] * region.size
            np.minimum(size, at_wall + _GROWTH_FROM_FACETS * region.distance(points), out=size)
    return size, first


def facet_edge(body: Body, longest: float) -> float:
    """Mean edge of a body's facets where edges are to be no longer than ``longest`` [length].

    Shapes made of facets keep them, those that are too long halved. On ellipsoids R_least^0.6 R^0.4 stands for the
    radius of curvature, fitted to ratios of axes up to 2.5.
    """
    d = body.dimension
    if body.facets is None:
        radius = equal_volume_radius(body)
        curvature = radius if body.least_radius is None else body.least_radius**0.6 * radius**0.4
        return min(_MEAN_OVER_LONGEST[d] * longest, curvature / _EDGES_PER_RADIUS)
    area = np.linalg.norm(area_vectors(body.facets.points, body.facets.vertices), axis=1)
    edge = _edge_of_regular(area, d)
    halvings = np.ceil(np.log2(np.maximum(edge / (LONGEST * longest), 1.0)))
    pieces = 2.0 ** ((d - 1) * halvings)
    return float(_edge_of_regular(area.sum() / pieces.sum(), d))


def _edge_of_regular(area: FloatArray, dimension: int) -> FloatArray:
    """Edge of a segment, or of an equilateral triangle, of an area [length]."""
    return area if dimension == 2 else np.sqrt(area * 4.0 / np.sqrt(3.0))
