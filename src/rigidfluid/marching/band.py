"""Which vertices belong to a band around a surface; kernels on arrays."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def in_band(points, neighbours, vertex, distance, band):
    """Tell whether a vertex at ``distance`` D is in a `field.Band`."""
    if distance <= band.width or band.slack == 0.0:
        return distance <= band.width
    short = (distance - band.width) / band.slack
    if len(neighbours.elsewhere) > 0 and neighbours.elsewhere[vertex] >= short * short:
        return True
    for k in range(neighbours.start[vertex], neighbours.start[vertex + 1]):
        if square_length(points, vertex, neighbours.members[k]) >= short * short:
            return True
    return False


@njit(cache=True, nogil=True)
def longest_edges(points, neighbours, vertices):
    """Square of the longest edge at each of some vertices, (v,)."""
    longest = np.zeros(len(vertices))
    for row in range(len(vertices)):
        for k in range(neighbours.start[vertices[row]], neighbours.start[vertices[row] + 1]):
            longest[row] = max(longest[row], square_length(points, vertices[row], neighbours.members[k]))
    return longest


@njit(cache=True, nogil=True, forceinline=True)
def square_in_band(points, neighbours, vertex, square, band):
    """`in_band` from the squared distance, which mostly needs no root."""
    if square <= band.width * band.width:
        return True
    return band.slack > 0.0 and in_band(points, neighbours, vertex, sqrt(square), band)


@njit(cache=True, nogil=True, forceinline=True)
def square_length(points, a, b):
    """Squared distance of two vertices."""
    total = 0.0
    for i in range(points.shape[1]):
        total += (points[b, i] - points[a, i]) ** 2
    return total
