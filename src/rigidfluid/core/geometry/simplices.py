"""Distances between vertices and facets: segments in the plane, triangles in space.

``points`` (N, d), ``facets`` (F, d). A nearest point is Σ w_i x_i over the corners x_i of its facet; in the plane the
third weight is zero. Which corners carry weight is one bit each.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, forceinline=True)
def vertex_to_facet(points, vertex, facets, facet):
    """Squared distance of a vertex to a facet, bits of the corners that carry weight, the three weights."""
    if points.shape[1] == 2:
        return _vertex_to_segment(points, vertex, facets[facet, 0], facets[facet, 1])
    return _vertex_to_triangle(points, vertex, facets[facet, 0], facets[facet, 1], facets[facet, 2])


@njit(cache=True, nogil=True)
def facet_to_facet(points, facets, first, second):
    """Squared distance of two facets that do not cross, weights (3) on the first, weights (3) on the second."""
    best = _corners_to_facet(points, facets, first, second)
    other = _corners_to_facet(points, facets, second, first)
    if other[0] < best[0]:
        best = (other[0], other[4], other[5], other[6], other[1], other[2], other[3])
    if points.shape[1] == 3:
        for i in range(3):
            for j in range(3):
                best = _edge_to_edge(points, facets, first, i, second, j, best)
    return best


@njit(cache=True, nogil=True)
def _corners_to_facet(points, facets, first, second):
    """The nearest of the first facet's corners: squared distance, weights on the first, weights on the second."""
    best = (np.inf, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(points.shape[1]):
        square, _, p, q, r = vertex_to_facet(points, facets[first, i], facets, second)
        if square < best[0]:
            best = (square, 1.0 * (i == 0), 1.0 * (i == 1), 1.0 * (i == 2), p, q, r)
    return best


@njit(cache=True, nogil=True, forceinline=True)
def _vertex_to_segment(points, vertex, a, b):
    abx, aby = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    apx, apy = points[vertex, 0] - points[a, 0], points[vertex, 1] - points[a, 1]
    along, length = abx * apx + aby * apy, abx * abx + aby * aby
    if along <= 0.0:
        return apx * apx + apy * apy, 1, 1.0, 0.0, 0.0
    if along >= length:
        bpx, bpy = points[vertex, 0] - points[b, 0], points[vertex, 1] - points[b, 1]
        return bpx * bpx + bpy * bpy, 2, 0.0, 1.0, 0.0
    cross = abx * apy - aby * apx
    t = along / length
    return cross * cross / length, 3, 1.0 - t, t, 0.0


@njit(cache=True, nogil=True, forceinline=True)
def _vertex_to_triangle(points, vertex, a, b, c):
    """Nearest point by the region of the triangle's plane that the vertex projects to: a corner's, an edge's or the
    inside."""
    d1 = _dot(points, a, b, a, vertex)
    d2 = _dot(points, a, c, a, vertex)
    if d1 <= 0.0 and d2 <= 0.0:
        return _squared_distance(points, vertex, a, b, c, 1, 1.0, 0.0, 0.0)
    d3 = _dot(points, a, b, b, vertex)
    d4 = _dot(points, a, c, b, vertex)
    if d3 >= 0.0 and d4 <= d3:
        return _squared_distance(points, vertex, a, b, c, 2, 0.0, 1.0, 0.0)
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        t = d1 / (d1 - d3)
        return _squared_distance(points, vertex, a, b, c, 3, 1.0 - t, t, 0.0)
    d5 = _dot(points, a, b, c, vertex)
    d6 = _dot(points, a, c, c, vertex)
    if d6 >= 0.0 and d5 <= d6:
        return _squared_distance(points, vertex, a, b, c, 4, 0.0, 0.0, 1.0)
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        t = d2 / (d2 - d6)
        return _squared_distance(points, vertex, a, b, c, 5, 1.0 - t, 0.0, t)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        return _squared_distance(points, vertex, a, b, c, 6, 0.0, 1.0 - t, t)
    total = va + vb + vc
    return _squared_distance(points, vertex, a, b, c, 7, va / total, vb / total, vc / total)


@njit(cache=True, nogil=True, forceinline=True)
def _dot(points, a, b, c, d):
    """(x_b - x_a)·(x_d - x_c) in space."""
    total = 0.0
    for k in range(3):
        total += (points[b, k] - points[a, k]) * (points[d, k] - points[c, k])
    return total


@njit(cache=True, nogil=True, forceinline=True)
def _squared_distance(points, vertex, a, b, c, bits, p, q, r):
    """Squared distance to the point of weights p, q, r from the residual itself, which loses nothing to cancellation;
    then the bits and the weights."""
    square = 0.0
    for k in range(3):
        x = points[vertex, k]
        step = p * (x - points[a, k]) + q * (x - points[b, k]) + r * (x - points[c, k])
        square += step * step
    return square, bits, p, q, r


@njit(cache=True, nogil=True)
def _edge_to_edge(points, facets, first, i, second, j, best):
    """``best``, or what is nearer between the insides of edge i of the first triangle and edge j of the second."""
    a, b = facets[first, i], facets[first, (i + 1) % 3]
    c, d = facets[second, j], facets[second, (j + 1) % 3]
    aa, cc, ac = _dot(points, a, b, a, b), _dot(points, c, d, c, d), _dot(points, a, b, c, d)
    det = aa * cc - ac * ac
    if det <= 1e-14 * aa * cc:
        return best  # parallel edges are nearest at a corner too
    ar, cr = _dot(points, a, b, a, c), _dot(points, c, d, a, c)
    s, t = (ar * cc - cr * ac) / det, (ar * ac - cr * aa) / det
    if s <= 0.0 or s >= 1.0 or t <= 0.0 or t >= 1.0:
        return best
    square = 0.0
    for k in range(3):
        step = (1.0 - s) * points[a, k] + s * points[b, k] - (1.0 - t) * points[c, k] - t * points[d, k]
        square += step * step
    if square >= best[0]:
        return best
    p, q, r = _edge_weights(i, s)
    u, v, w = _edge_weights(j, t)
    return square, p, q, r, u, v, w


@njit(cache=True, nogil=True)
def _edge_weights(edge, s):
    if edge == 0:
        return 1.0 - s, s, 0.0
    if edge == 1:
        return 0.0, 1.0 - s, s
    return s, 0.0, 1.0 - s
