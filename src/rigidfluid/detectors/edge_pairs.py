"""Edges of two bodies that pass each other: arrays in, arrays out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

_PARALLEL = 1e-12
"""Squared sine of the angle below which edges are nearest at their ends, too."""


@njit(cache=True, nogil=True)
def passing_edges(points_a, edges_a, points_b, edges_b, reach):
    """Edges that are nearest inside both of them, within ``reach``: their rows in a and in b, the points of a and of b.

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
    first, second = np.empty((2, len(rows)), np.int64)
    point_a, point_b = np.empty((2, len(rows), 3))
    count = 0
    for i, j, t, v in rows:
        square = 0.0
        for k in range(3):
            point_a[count, k] = (1.0 - t) * points_a[edges_a[i, 0], k] + t * points_a[edges_a[i, 1], k]
            point_b[count, k] = (1.0 - v) * points_b[edges_b[j, 0], k] + v * points_b[edges_b[j, 1], k]
            square += (point_a[count, k] - point_b[count, k]) ** 2
        if square > 0.0 and sqrt(square) <= reach:
            first[count], second[count] = i, j
            count += 1
    return first[:count], second[:count], point_a[:count], point_b[:count]


@njit(cache=True, nogil=True, forceinline=True)
def _beyond(p, q, r, s, reach):
    """Tell whether the boxes around two edges are farther apart than ``reach`` along some axis."""
    apart = -np.inf
    for k in range(3):
        apart = max(apart, min(r[k], s[k]) - max(p[k], q[k]), min(p[k], q[k]) - max(r[k], s[k]))
    return apart > reach
