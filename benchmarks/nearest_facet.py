"""The distance to the nearest of all facets, one by one: what a march is checked against."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.simplices import vertex_to_facet


def nearest_facet_distances(points: FloatArray, corners: FloatArray) -> FloatArray:
    """min |x - y| over all facets y, (N,), of ``points`` x (N, d), for facets with ``corners`` (F, d, d) [length]."""
    together = np.concatenate([points, corners.reshape(-1, points.shape[1])])
    facets = np.arange(len(points), len(together), dtype=np.int32).reshape(len(corners), -1)
    distances: FloatArray = np.sqrt(_least_squares(together, facets, len(points)))
    return distances


@njit(nogil=True)
def _least_squares(points, facets, count):
    least = np.full(count, np.inf)
    for vertex in range(count):
        for facet in range(len(facets)):
            least[vertex] = min(least[vertex], vertex_to_facet(points, vertex, facets, facet)[0])
    return least
