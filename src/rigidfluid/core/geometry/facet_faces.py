"""The faces of a surface of facets: its vertices, its edges, and the facets' insides."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.geometry.ridges import ridges_of

_VERTICES = np.array([0, 1, 3])
_EDGES = np.array([2, 5, 4])
"""Bits (less one) of the corners of a facet's vertices, and of its edges in the order of its ridges."""


class Faces(NamedTuple):
    """Faces of each facet, in columns by the bits (less one) of the corners that span them.

    ``numbers`` (F, 2^d - 1) of the vertices, edges and insides, those of the vertices their rows of points; ``normals``
    (F, 2^d - 1, d), unit means of those of the facets that meet there, at vertices weighted by their angles;
    ``facets_at``, how many facets meet at each number.
    """

    numbers: IntArray
    normals: FloatArray
    facets_at: IntArray


def faces_of(points: FloatArray, vertices: IntArray) -> Faces:
    """The faces of facets ``vertices`` (F, d) between ``points`` (N, d), which they share."""
    count, dimension = vertices.shape
    numbers = np.empty((count, 2**dimension - 1), dtype=np.int64)
    weight = np.ones(numbers.shape)
    numbers[:, _VERTICES[:dimension]] = vertices
    edges = 0
    if dimension == 3:
        weight[:, _VERTICES] = _angles(points[vertices])
        ridges = ridges_of(vertices)
        edges = len(ridges.corners)
        numbers[:, _EDGES] = len(points) + ridges.number
    numbers[:, -1] = len(points) + edges + np.arange(count)
    total = np.zeros((len(points) + edges + count, dimension))
    np.add.at(total, numbers, weight[:, :, None] * unit(area_vectors(points, vertices))[:, None])
    return Faces(numbers, unit(total)[numbers], np.bincount(numbers.ravel(), minlength=len(total)))


def unit(vectors: FloatArray) -> FloatArray:
    """Unit vectors along the last axis; zero for vectors without a direction, as between two sides of a blade."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))


def _angles(corners: FloatArray) -> FloatArray:
    """Angles at the corners of triangles (F, 3, 3), (F, 3) [rad]."""
    ahead, behind = unit(np.roll(corners, -1, axis=1) - corners), unit(np.roll(corners, 1, axis=1) - corners)
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(ahead - behind, axis=2), np.linalg.norm(ahead + behind, axis=2)))
