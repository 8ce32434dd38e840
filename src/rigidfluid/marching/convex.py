"""Convexity of a surface, seen from the fluid; kernels on arrays."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def is_convex(points, surfaces, chosen):
    """Tell whether the facets ``chosen``, one closed piece, are the surface of a convex body.

    It is convex at each of its ridges: no facet's neighbour rises above its plane into the fluid.
    """
    normal = np.empty(points.shape[1])
    for facet in chosen:
        if surfaces.across[facet] < 0:
            return False  # no cell tells the fluid's side
        _write_normal(points, surfaces, facet, normal)
        corners = surfaces.facets[facet]
        for neighbour in surfaces.neighbours[facet]:
            for vertex in surfaces.facets[neighbour]:
                if vertex not in corners and _height(points, vertex, corners[0], normal) > 0.0:
                    return False
    return True


@njit(cache=True, nogil=True)
def _write_normal(points, surfaces, facet, normal):
    """Write the facet's normal, of any length, into the fluid: towards the cell that it belongs to."""
    corners = surfaces.facets[facet]
    a, b = corners[0], corners[1]
    if len(normal) == 2:
        normal[0], normal[1] = points[a, 1] - points[b, 1], points[b, 0] - points[a, 0]
    else:
        c = corners[2]
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            normal[k] = (points[b, i] - points[a, i]) * (points[c, j] - points[a, j])
            normal[k] -= (points[b, j] - points[a, j]) * (points[c, i] - points[a, i])
    if _height(points, surfaces.across[facet], a, normal) < 0.0:
        normal *= -1.0


@njit(cache=True, nogil=True)
def _height(points, vertex, origin, normal):
    """Height of a vertex above the plane through ``origin``, times the length of ``normal``."""
    total = 0.0
    for k in range(len(normal)):
        total += (points[vertex, k] - points[origin, k]) * normal[k]
    return total
