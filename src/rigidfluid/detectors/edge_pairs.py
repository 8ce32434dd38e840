"""Edges of two bodies that pass each other: arrays in, arrays out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

_PARALLEL = 1e-12
"""Squared sine of the angle below which edges are nearest at their ends, too."""


@njit(cache=True, nogil=True)
def passing_edges(points_a, edges_a, points_b, edges_b, reach):
    """Edges that are nearest inside both of them, within ``reach``: the points of a and of b, with sign 1, and those of
    the nearest pair of an end and the other edge, with sign -1.

    In space; ``points`` (N, 3) and ``edges`` (E, 2) of each.
    """
    rows = [(0, 0, 0.0, 0.0) for _ in range(0)]
    for i in range(len(edges_a)):
        p, q = points_a[edges_a[i, 0]], points_a[edges_a[i, 1]]
        for j in range(len(edges_b)):
            r, s = points_b[edges_b[j, 0]], points_b[edges_b[j, 1]]
            if _beyond(p, q, r, s, reach):
                continue
            aa = bb = ab = ar = br = 0.0
            for k in range(3):
                u, v, w = q[k] - p[k], s[k] - r[k], r[k] - p[k]
                aa, bb, ab = aa + u * u, bb + v * v, ab + u * v
                ar, br = ar + u * w, br + v * w
            det = aa * bb - ab * ab
            if det <= _PARALLEL * aa * bb:
                continue
            t, v = (ar * bb - br * ab) / det, (ar * ab - br * aa) / det
            if 0.0 < t < 1.0 and 0.0 < v < 1.0:
                rows.append((i, j, t, v))
    point_a, point_b = np.empty((2, 2 * len(rows), 3))
    sign = np.empty(2 * len(rows))
    count = 0
    for i, j, t, v in rows:
        p, q = points_a[edges_a[i, 0]], points_a[edges_a[i, 1]]
        r, s = points_b[edges_b[j, 0]], points_b[edges_b[j, 1]]
        near = _between(p, q, t, r, s, v)
        if not 0.0 < near <= reach * reach:
            continue
        least, at, on = np.inf, 0.0, 0.0
        for end in (0.0, 1.0):
            at_other = _nearest_part(r, s, p if end == 0.0 else q)
            square = _between(p, q, end, r, s, at_other)
            if square < least:
                least, at, on = square, end, at_other
            at_other = _nearest_part(p, q, r if end == 0.0 else s)
            square = _between(p, q, at_other, r, s, end)
            if square < least:
                least, at, on = square, at_other, end
        for place in range(2):
            if place == 1 and least > reach * reach:
                break
            one, other = (t, v) if place == 0 else (at, on)
            for k in range(3):
                point_a[count, k] = (1.0 - one) * p[k] + one * q[k]
                point_b[count, k] = (1.0 - other) * r[k] + other * s[k]
            sign[count] = 1.0 - 2.0 * place
            count += 1
    return point_a[:count], point_b[:count], sign[:count]


@njit(cache=True, nogil=True, forceinline=True)
def _between(p, q, t, r, s, v):
    """Squared distance of the points at the parts t and v of two edges."""
    square = 0.0
    for k in range(3):
        square += ((1.0 - t) * p[k] + t * q[k] - (1.0 - v) * r[k] - v * s[k]) ** 2
    return square


@njit(cache=True, nogil=True, forceinline=True)
def _nearest_part(p, q, point):
    """Part of an edge, from 0 to 1, at which it is nearest to a point."""
    along = length = 0.0
    for k in range(3):
        along += (q[k] - p[k]) * (point[k] - p[k])
        length += (q[k] - p[k]) ** 2
    return min(max(along / length, 0.0), 1.0)


@njit(cache=True, nogil=True, forceinline=True)
def _beyond(p, q, r, s, reach):
    """Tell whether the boxes around two edges are farther apart than ``reach`` along some axis."""
    apart = -np.inf
    for k in range(3):
        apart = max(apart, min(r[k], s[k]) - max(p[k], q[k]), min(p[k], q[k]) - max(r[k], s[k]))
    return apart > reach
