"""Cell list: the surfaces near each ball, from the balls in its own and adjacent cells of a grid."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

_WIDER = 1.0 + 1e-9
"""Least width of a cell over the longest distance of a pair: rounding then moves no ball beyond an adjacent cell."""

_CELLS_PER_BALL = 8
"""Greatest number of cells over that of balls; wider ones are taken if the balls are far apart."""


@njit(cache=True, nogil=True, error_model="numpy")
def near_each_ball(position, radii, planes, reach):
    """Surfaces within ``reach`` of each of n balls [length]: balls of higher numbers, and flat walls from n on, sorted.

    Ball a has ``second[start[a]:start[a + 1]]`` of ``start`` (n + 1,) and ``second``. Gaps are |x_a - x_b| -
    r_a - r_b and (x_a - p)·n - r_a for a point p and the normal n of each of ``planes`` (w, 2, d).
    """
    count, dimension = position.shape
    largest = 0.0
    for a in range(count):
        largest = max(largest, radii[a])
    far = reach + 1e-12 * (largest + abs(reach))
    cell, shape = _cells(position, (far + 2.0 * largest) * _WIDER)
    first, members = _members(cell, shape)
    start, second, found = np.empty(count + 1, np.int64), np.empty(8 * count + 8, np.int64), 0
    for a in range(count):
        start[a] = found
        x, y, z = cell[a, 0], cell[a, 1], cell[a, 2]
        for i in range(max(x - 1, 0), min(x + 2, shape[0])):
            for j in range(max(y - 1, 0), min(y + 2, shape[1])):
                row = (i * shape[1] + j) * shape[2]
                begin, end = first[row + max(z - 1, 0)], first[row + min(z + 2, shape[2])]
                if found + end - begin > len(second):
                    second = _longer(second, end - begin)
                for member in range(begin, end):
                    b = members[member]
                    if b > a and _are_near(position, radii, far, a, b):
                        place = found
                        while place > start[a] and second[place - 1] > b:
                            second[place] = second[place - 1]
                            place -= 1
                        second[place] = b
                        found += 1
        if found + len(planes) > len(second):
            second = _longer(second, len(planes))
        for wall in range(len(planes)):
            height = 0.0
            for k in range(dimension):
                height += (position[a, k] - planes[wall, 0, k]) * planes[wall, 1, k]
            if height - radii[a] <= far:
                second[found] = count + wall
                found += 1
    start[count] = found
    return start, second[:found].copy()


@njit(cache=True, nogil=True)
def _longer(array, more):
    """The array with room for at least so many ``more``."""
    return np.concatenate((array, np.empty(max(len(array), more), np.int64)))


@njit(cache=True, nogil=True)
def _are_near(position, radii, far, a, b):
    square = 0.0
    for k in range(position.shape[1]):
        square += (position[a, k] - position[b, k]) ** 2
    return square <= max(radii[a] + radii[b] + far, 0.0) ** 2


@njit(cache=True, nogil=True, error_model="numpy")
def _cells(position, width):
    """Cell of each ball (n, 3), and the numbers of cells along three axes, of which a plane has one along the last."""
    count, dimension = position.shape
    most = _CELLS_PER_BALL * (count + 1)
    shape, low, high = np.ones(3, np.int64), np.zeros(3), np.zeros(3)
    for k in range(dimension if count else 0):
        low[k], high[k] = position[:, k].min(), position[:, k].max()
        ratio = (high[k] - low[k]) / width
        if ratio > 1.0:  # not for one that is no number
            shape[k] = int(min(ratio, most))
    while float(shape[0]) * shape[1] * shape[2] > most:  # as numbers that do not overflow
        shape[np.argmax(shape)] //= 2
    cell = np.zeros((count, 3), np.int64)
    for k in range(dimension):
        scale = shape[k] / (high[k] - low[k]) if shape[k] > 1 else 0.0
        for a in range(count):
            place = (position[a, k] - low[k]) * scale
            if place > 0.0:
                cell[a, k] = int(min(place, shape[k] - 1))
    return cell, shape


@njit(cache=True, nogil=True)
def _members(cell, shape):
    """Balls cell by cell: those of cell c are ``members[first[c]:first[c + 1]]``."""
    first = np.zeros(shape[0] * shape[1] * shape[2] + 1, np.int64)
    number = (cell[:, 0] * shape[1] + cell[:, 1]) * shape[2] + cell[:, 2]
    for here in number:
        first[here + 1] += 1
    first = np.cumsum(first)
    members, place = np.empty(len(cell), np.int64), first.copy()
    for a in range(len(cell)):
        members[place[number[a]]] = a
        place[number[a]] += 1
    return first, members
