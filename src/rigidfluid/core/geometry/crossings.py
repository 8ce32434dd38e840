"""Finds edges that go through facets: of a surface that crosses itself, or of two bodies in one another."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facet_tree import build_tree, leaves_beside

_FLAT = 1e-7
"""Volumes of an edge within the plane of a facet are below this, over the cube around both: the single precision of STL
files puts corners off their plane."""


def first_crossing(points: FloatArray, facets: IntArray) -> tuple[int, int] | None:
    """Two of the ``facets`` (F, d) between ``points`` (N, d) that meet without sharing a vertex; None if no two do."""
    corners, d = facets.astype(np.int32), points.shape[1]
    edges = corners if d == 2 else np.concatenate([corners[:, [i, (i + 1) % d]] for i in range(d)])
    points = np.ascontiguousarray(points, dtype=float)
    found = crossings(points, edges, build_tree(points, corners, np.arange(len(corners), dtype=np.int32)))
    return (int(found[0, 0]) % len(facets), int(found[0, 1])) if len(found) else None


@njit(cache=True, nogil=True)
def crossings(points, edges, tree):
    """Pairs (c, 2) of an edge and a facet of the tree that meet without sharing a vertex; in space not within a plane.

    ``points`` (N, d) of both, ``edges`` (E, 2); in the plane facets are edges too.
    """
    facets, found = tree.facets, [(0, 0) for _ in range(0)]
    for edge in range(len(edges)):
        for facet in leaves_beside(points, edges[edge], tree):
            if _apart(points, edges[edge], facets[facet]) or _share(edges[edge], facets[facet]):
                continue
            if _meet(points, edges[edge], facets[facet]):
                found.append((edge, facet))
    pairs = np.empty((len(found), 2), np.int64)
    for row in range(len(found)):
        pairs[row, 0], pairs[row, 1] = found[row]
    return pairs


@njit(cache=True, nogil=True)
def _apart(points, edge, facet):
    """Tell whether the boxes around both do not meet: of parts of one straight line, rounding alone says on which side
    of each other they are."""
    for k in range(points.shape[1]):
        low, high = min(points[edge[0], k], points[edge[1], k]), max(points[edge[0], k], points[edge[1], k])
        below = above = True
        for corner in facet:
            below, above = below and points[corner, k] < low, above and points[corner, k] > high
        if below or above:
            return True
    return False


@njit(cache=True, nogil=True)
def _share(edge, facet):
    for i in edge:
        for j in facet:
            if i == j:
                return True
    return False


@njit(cache=True, nogil=True)
def _meet(points, edge, facet):
    p, q = edge
    if points.shape[1] == 2:
        a, b = facet
        sides = _turn(points, a, b, p), _turn(points, a, b, q), _turn(points, p, q, a), _turn(points, p, q, b)
        if sides[0] == 0.0 and sides[1] == 0.0:
            return _within(points, p, a, b) or _within(points, q, a, b) or _within(points, a, p, q)
        return sides[0] * sides[1] <= 0.0 and sides[2] * sides[3] <= 0.0
    a, b, c = facet
    below, above = _volume(points, a, b, c, p), _volume(points, a, b, c, q)
    if below * above > 0.0 or max(abs(below), abs(above)) <= _FLAT * _extent(points, p, q, a, b, c) ** 3:
        return False
    u, v, w = _volume(points, p, q, a, b), _volume(points, p, q, b, c), _volume(points, p, q, c, a)
    return (u != 0.0 or v != 0.0 or w != 0.0) and (min(u, v, w) >= 0.0 or max(u, v, w) <= 0.0)


@njit(cache=True, nogil=True)
def _extent(points, p, q, a, b, c):
    """The longest side of the box around an edge and a facet."""
    longest = 0.0
    for axis in range(3):
        given = points[p, axis], points[q, axis], points[a, axis], points[b, axis], points[c, axis]
        longest = max(longest, max(given) - min(given))
    return longest


@njit(cache=True, nogil=True)
def _turn(points, a, b, p):
    """Twice the area of a, b, p, positive where they go round to the left."""
    ab, ap = points[b] - points[a], points[p] - points[a]
    return ab[0] * ap[1] - ab[1] * ap[0]


@njit(cache=True, nogil=True)
def _within(points, p, a, b):
    """Tell whether p is between a and b on their line."""
    return np.sum((points[p] - points[a]) * (points[p] - points[b])) <= 0.0


@njit(cache=True, nogil=True)
def _volume(points, a, b, c, p):
    """Six times the volume of a, b, c, p, positive where p sees a, b, c go round to the right."""
    ab, ac, ap = points[b] - points[a], points[c] - points[a], points[p] - points[a]
    return (
        (ab[1] * ac[2] - ab[2] * ac[1]) * ap[0]
        + (ab[2] * ac[0] - ab[0] * ac[2]) * ap[1]
        + (ab[0] * ac[1] - ab[1] * ac[0]) * ap[2]
    )
