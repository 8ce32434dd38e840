"""Which vertices belong to a band around a surface. Arrays in, an answer out."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

from numba import njit


@njit(cache=True, nogil=True)
def in_band(points, neighbours, vertex, distance, width, slack):
    """Whether D ≤ ``width`` + ``slack`` L for a vertex at ``distance`` D, L its longest edge."""
    if distance <= width or slack == 0.0:
        return distance <= width
    short = (distance - width) / slack
    for k in range(neighbours.start[vertex], neighbours.start[vertex + 1]):
        square = 0.0
        for i in range(points.shape[1]):
            square += (points[neighbours.members[k], i] - points[vertex, i]) ** 2
        if square >= short * short:
            return True
    return False


@njit(cache=True, nogil=True, forceinline=True)
def square_in_band(points, neighbours, vertex, square, width, slack):
    """`in_band` from the squared distance, which mostly needs no root."""
    return square <= width * width or (slack > 0.0 and in_band(points, neighbours, vertex, sqrt(square), width, slack))
