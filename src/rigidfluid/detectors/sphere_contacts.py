"""Contacts of balls with balls and flat walls: arrays in, arrays out.

Balls are a ``position`` (n, d) and ``radii`` (n,) [length]; flat walls are ``planes`` (w, 2, d), a point and the unit
normal of each, and their rising numbers ``surfaces`` (w,).
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def _square(position, a, b):
    """Square of the distance of two centres; written out, since most pairs go no further."""
    x, y = position[a, 0] - position[b, 0], position[a, 1] - position[b, 1]
    if position.shape[1] == 2:
        return x * x + y * y
    z = position[a, 2] - position[b, 2]
    return x * x + y * y + z * z


@njit(cache=True, nogil=True, error_model="numpy")
def _height(position, a, planes, wall):
    """Distance of a centre from a plane."""
    height = 0.0
    for k in range(position.shape[1]):
        height += (position[a, k] - planes[wall, 0, k]) * planes[wall, 1, k]
    return height


@njit(cache=True, nogil=True, error_model="numpy")
def _near_surfaces(balls, pairs, walls, reach):
    """Balls a, surfaces b near them and gaps ≤ ``reach`` [length], (m,) each, sorted by (a, b).

    The ``pairs``, a start and the partners, are ball a with ``second[start[a]:start[a + 1]]``: balls of higher numbers,
    and walls numbered from n on.
    """
    (position, radii), (start, second), (planes, surfaces) = balls, pairs, walls
    count = len(position)
    body, other, gap = np.empty(len(second), np.int64), np.empty(len(second), np.int64), np.empty(len(second))
    found = 0
    for a in range(count):
        for pair in range(start[a], start[a + 1]):
            b = second[pair]
            if b < count:
                square = _square(position, a, b)
                # a root for those alone that may be near
                if square > 1.001 * max(radii[a] + radii[b] + reach, 0.0) ** 2:
                    continue
                free = np.sqrt(square) - radii[a] - radii[b]
            else:
                free, b = _height(position, a, planes, b - count) - radii[a], surfaces[b - count]
            if free <= reach:
                body[found], other[found], gap[found] = a, b, free
                found += 1
    return body[:found].copy(), other[:found].copy(), gap[:found].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def _points_and_normals(balls, walls, body, other):
    """Nearest points of a and of b [length], and normals, (m, d) each, of the balls a and surfaces b of
    `_near_surfaces`.

    The normal of balls with a common centre is the first axis.
    """
    (position, radii), (planes, surfaces) = balls, walls
    dimension = position.shape[1]
    point_a, point_b = np.empty((len(body), dimension)), np.empty((len(body), dimension))
    normal = np.empty((len(body), dimension))
    for i in range(len(body)):
        a, b = body[i], other[i]
        if b < len(position):
            square = _square(position, a, b)
            distance = np.sqrt(square)
            for k in range(dimension):
                axis = 1.0 if k == 0 else 0.0
                normal[i, k] = (position[a, k] - position[b, k]) / distance if distance > 0.0 else axis
                point_b[i, k] = position[b, k] + radii[b] * normal[i, k]
        else:
            wall = np.searchsorted(surfaces, b)
            height = _height(position, a, planes, wall)
            for k in range(dimension):
                normal[i, k] = planes[wall, 1, k]
                point_b[i, k] = position[a, k] - height * normal[i, k]
        for k in range(dimension):
            point_a[i, k] = position[a, k] - radii[a] * normal[i, k]
    return point_a, point_b, normal


@njit(cache=True, nogil=True, error_model="numpy")
def contact_columns(balls, pairs, walls, reach):
    """Columns of `Contacts` up to the effective radius, of the contacts that `_near_surfaces` finds."""
    body, other, gap = _near_surfaces(balls, pairs, walls, reach)
    point_a, point_b, normal = _points_and_normals(balls, walls, body, other)
    radii, count = balls[1], len(body)
    radius_a, radius_b, at_wall = np.empty(count), np.empty(count), np.empty(count, np.bool_)
    for i in range(count):
        at_wall[i] = other[i] >= len(radii)
        radius_a[i] = radii[body[i]]
        radius_b[i] = np.inf if at_wall[i] else radii[other[i]]
    effective = 1.0 / (1.0 / radius_a + 1.0 / radius_b)
    return body, other, point_a, point_b, normal, gap, radius_a, radius_b, at_wall, effective
