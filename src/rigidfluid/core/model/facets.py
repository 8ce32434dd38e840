"""A surface made of simplices: what a polygon, a polyhedron, or a boundary read from a file is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.types import FloatArray, IntArray


@dataclass(frozen=True)
class Facets:
    """A closed surface of straight edges (2D) or flat triangles (3D).

    ``points`` (N, d) [length]; ``vertices`` (F, d), the corners of each facet, in such an order that its normal points
    into the fluid: (y_b - y_a, x_a - x_b) of an edge from a to b, (b - a) × (c - a) of a triangle; ``markers`` (F,),
    the piece of a domain's boundary that each facet is on, 0 of a body's.
    """

    points: FloatArray
    vertices: IntArray
    markers: IntArray


def area_vectors(points: FloatArray, vertices: IntArray) -> FloatArray:
    """Area (length in 2D) times unit normal of each facet, (F, d), for ``points`` and ``vertices`` as in `Facets`
    [length^(d-1)]."""
    corners = points[vertices]
    edges = corners[:, 1:] - corners[:, :1]
    if points.shape[1] == 2:
        return np.stack([edges[:, 0, 1], -edges[:, 0, 0]], axis=1)
    return np.asarray(0.5 * np.cross(edges[:, 0], edges[:, 1]))
