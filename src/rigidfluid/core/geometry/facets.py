"""A surface made of simplices: what a polygon, a polyhedron, or a boundary read from a file is."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray

LARGEST = 1e30
"""Largest coordinate that is read from a file, as of numbers in a scene: powers of it stay finite [length]."""


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

    def part(self, chosen: BoolArray) -> Facets:
        """The ``chosen`` facets (F,), between the same points."""
        return Facets(self.points, self.vertices[chosen], self.markers[chosen])


def area_vectors(points: FloatArray, vertices: IntArray) -> FloatArray:
    """Area (length in 2D) times unit normal of each facet, (F, d), for ``points`` and ``vertices`` as in `Facets`
    [length^(d-1)]."""
    corners = points[vertices]
    edges = corners[:, 1:] - corners[:, :1]
    if points.shape[1] == 2:
        return np.stack([edges[:, 0, 1], -edges[:, 0, 0]], axis=1)
    return np.asarray(0.5 * np.cross(edges[:, 0], edges[:, 1]))


def enclosed_volume(points: FloatArray, vertices: IntArray) -> float:
    """Volume that closed facets enclose, Σ det(x_1, …, x_d)/d! about one of their corners, negative where their normals
    point inwards, for ``points`` and ``vertices`` as in `Facets` [length^d]."""
    corners = points[vertices] - points[vertices[0, 0]]
    return float(np.linalg.det(corners).sum()) / factorial(corners.shape[1])


def place(points: FloatArray) -> str:
    """The middle of points (N, d), as messages show it."""
    return "(" + ", ".join(f"{x:.6g}" for x in points.mean(axis=0)) + ")"
