"""Where a surface is concave as seen from the fluid. Arrays in, answers written to an array."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def mark_concave(points, surfaces, wanted, seeds, concave):
    """Write to ``concave`` for each facet of ``seeds`` whether one that touches it has a corner above its plane.

    Where none has, a vertex that projects into the facet is nearer to it than to any that touches it.
    """
    normal = np.empty(points.shape[1])
    for facet in seeds:
        concave[facet] = True  # where no cell tells the fluid's side
        if surfaces.across[facet] >= 0:
            _towards_fluid(points, surfaces, facet, normal)
            concave[facet] = _any_above(points, surfaces, wanted, facet, normal)


@njit(cache=True, nogil=True)
def _any_above(points, surfaces, wanted, facet, normal):
    origin = surfaces.facets[facet, 0]
    for corner in surfaces.facets[facet]:
        for k in range(surfaces.start[corner], surfaces.start[corner + 1]):
            other = surfaces.members[k]
            if wanted[surfaces.marker[other]]:
                for vertex in surfaces.facets[other]:
                    if _height(points, vertex, origin, normal) > 0.0:
                        return True
    return False


@njit(cache=True, nogil=True)
def _towards_fluid(points, surfaces, facet, normal):
    """Write a vector across the facet, of any length, towards the cell it belongs to."""
    corners = surfaces.facets[facet]
    origin = corners[0]
    edge = points[corners[1]] - points[origin]
    if len(normal) == 2:
        normal[0], normal[1] = -edge[1], edge[0]
    else:
        second = points[corners[2]] - points[origin]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            normal[k] = edge[i] * second[j] - edge[j] * second[i]
    if _height(points, surfaces.across[facet], origin, normal) < 0.0:
        normal *= -1.0


@njit(cache=True, nogil=True)
def _height(points, vertex, origin, normal):
    total = 0.0
    for k in range(len(normal)):
        total += (points[vertex, k] - points[origin, k]) * normal[k]
    return total
