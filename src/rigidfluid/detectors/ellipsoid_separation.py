"""The direction in which two ellipsoids are farthest apart, by Newton's method on the sphere of directions.

An ellipsoid is its centre and a matrix S = R diag(a), so that its surface is S u over all unit vectors u. In direction
n it reaches h(n) = |Sᵀn| from its centre, to the point S Sᵀn/h. With c = x_a - x_b the plane gap of two of them is

    g(n) = n·c - h_a(n) - h_b(n),

and the gap is its largest value over all unit n. A local maximum with g > 0 is the largest, as g is concave over
the cone of all vectors. If they overlap, -g is the distance from the inside of their Minkowski sum to its surface; a
local maximum is the largest for sure if -g is at most the sum's least radius of curvature, for then a ball of that
radius rolls in it freely (Blaschke). Deeper than that, many starts are tried and the best is kept.

All vectors are triples: in the plane the third component of c and n is zero, and a third semi-axis along z, as long as
the first, changes nothing.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from rigidfluid.detectors.triples import cross, dot, plus, times, triple, turned, turned_back, unit

FOUND, BEYOND, LOST = 0, 1, 2
"""States of a pair: its normal is found, its gap is beyond reach, or the highest climb came to no rest."""

# a vector without a direction becomes NaN, and a pair with NaN is LOST
_kernel = njit(cache=True, nogil=True, error_model="numpy")

_EPSILON = float(np.finfo(float).eps)
_MOST_STEPS = 200
_MOST_HALVINGS = 60
_NEARLY = 1e-11
"""Slope over size, or length of a step, after which one more step of Newton's method is as good as it gets."""
_BISECTIONS = 40


@_kernel
def separate(offset, first, second, half, directions, reach, normal, state):
    """Write the unit ``normal`` (m, 3) from b to a of pairs of ellipsoids, and ``state`` (m,): FOUND, BEYOND or LOST.

    ``offset`` (m, 3) is the centre of a minus that of b [length], ``first`` and ``second`` (m,) are their numbers,
    ``half`` (n, 3, 3) the matrices S [length]. ``directions`` (k, 3) are unit vectors to start from in a deep overlap.
    Pairs with a gap above ``reach`` [length] are given up as soon as that is known.
    """
    for k in range(len(first)):
        c = triple(offset[k])
        n, gap, found = _widest(c, half[first[k]], half[second[k]], directions, reach)
        normal[k, 0], normal[k, 1], normal[k, 2] = n
        state[k] = LOST if not found else BEYOND if gap > reach else FOUND


@_kernel
def _widest(c, a, b, directions, reach):
    """The direction of the largest plane gap, that gap, and whether it was found."""
    n, gap, found = (1.0, 0.0, 0.0), -np.inf, False
    square = dot(c, c)
    if not square < np.inf:
        return n, gap, False
    if square > 0.0:
        line = unit(c)
        bound = _plane_gap(line, c, a, b)
        if bound > reach:
            return line, bound, True
        n, gap, found = _climb(touching_normal(c, a, b), c, a, b, reach)
        if found and gap >= -_least_radius(a) - _least_radius(b):
            return n, gap, True
    for k in range(len(directions)):
        u = triple(directions[k])
        for start in (_normal_at(a, u), _normal_at(b, u)):
            other, height, rests = _climb(unit(start), c, a, b, reach)
            if height > gap:
                n, gap, found = other, height, rests
    return n, gap, found


@_kernel
def _climb(n, c, a, b, reach):
    """Newton's method from a direction up to a local maximum of g: the direction there, g, and whether it is one.

    It ends early where g is beyond reach.
    """
    size = sqrt(dot(c, c)) + _extremes(a)[1] + _extremes(b)[1]
    for _ in range(_MOST_STEPS):
        gap = _plane_gap(n, c, a, b)
        if gap > reach:
            return n, gap, True
        slope, step = _newton(n, gap, size, c, a, b)
        length = sqrt(dot(step, step))
        if length <= _NEARLY or dot(slope, slope) <= (_NEARLY * size) ** 2:
            tried = unit(plus(n, 1.0, step))
            height = _plane_gap(tried, c, a, b)
            # where g is flat in some direction the step is arbitrary
            return (tried, height, True) if height >= gap - 4.0 * _EPSILON * size else (n, gap, True)
        least, rise = gap - 4.0 * _EPSILON * size, 1e-4 * dot(slope, step)
        share = min(1.0, 1.0 / length)
        for _ in range(_MOST_HALVINGS):
            tried = unit(plus(n, share, step))
            if _plane_gap(tried, c, a, b) >= least + share * rise:
                break
            share *= 0.5
        else:
            return n, gap, False
        n = tried
    return n, gap, False


@_kernel
def _newton(n, gap, size, c, a, b):
    """Slope of g across n, and Newton's step; where g curves upwards the step goes up all the same."""
    t, u = _tangents(n)
    apart = plus(plus(c, -1.0, _farthest(a, n)), -1.0, _farthest(b, n))
    p, q = dot(apart, t), dot(apart, u)
    tt_a, tu_a, uu_a = _radii(a, n, t, u)
    tt_b, tu_b, uu_b = _radii(b, n, t, u)
    x, y = _turned_solve(tt_a + tt_b + gap, tu_a + tu_b, uu_a + uu_b + gap, p, q, _EPSILON * size)
    return plus(times(p, t), q, u), plus(times(x, t), y, u)


@_kernel
def _radii(s, n, t, u):
    """Second derivatives of h across n: the radii of curvature of the surface, in the directions t and u."""
    v = turned_back(s, n)
    height = sqrt(dot(v, v))
    w, z = turned_back(s, t), turned_back(s, u)
    # projected before they are multiplied, as the difference of the products would lose all digits on a needle
    w = plus(w, -dot(w, v) / height**2, v)
    z = plus(z, -dot(z, v) / height**2, v)
    return dot(w, w) / height, dot(w, z) / height, dot(z, z) / height


@_kernel
def _turned_solve(tt, tu, uu, p, q, least):
    """The solution of [[tt, tu], [tu, uu]] (x, y) = (p, q) with both eigenvalues made positive, at least ``least``."""
    mean, half = 0.5 * (tt + uu), 0.5 * (tt - uu)
    radius = sqrt(half**2 + tu**2)
    cosine, sine = (half + radius, tu) if half >= 0.0 else (tu, radius - half)
    length = sqrt(cosine**2 + sine**2)
    if length == 0.0:
        cosine, sine, length = 1.0, 0.0, 1.0
    cosine, sine = cosine / length, sine / length
    along = (cosine * p + sine * q) / max(abs(mean + radius), least)
    across = (cosine * q - sine * p) / max(abs(mean - radius), least)
    return cosine * along - sine * across, sine * along + cosine * across


@_kernel
def touching_normal(c, a, b):
    """The normal where both, blown up or shrunk by the same factor, touch (Perram and Wertheim's contact function).

    It is y/|y| with ((1 - λ) S_a S_aᵀ + λ S_b S_bᵀ) y = c and λ such that (1 - λ) h_a(y) = λ h_b(y). There g has the
    sign of the gap, so that it is a good place to start from.
    """
    low, high = 0.0, 1.0
    for _ in range(_BISECTIONS):
        share = 0.5 * (low + high)
        y = _solve(_blend(a, b, share), c)
        v, w = turned_back(a, y), turned_back(b, y)
        if (1.0 - share) ** 2 * dot(v, v) > share**2 * dot(w, w):
            low = share
        else:
            high = share
    return unit(y)


@_kernel
def _normal_at(s, u):
    """A vector along the normal of the ellipsoid at its point S u."""
    n = (0.0, 0.0, 0.0)
    for j in range(3):
        column = (s[0, j], s[1, j], s[2, j])
        n = plus(n, u[j] / dot(column, column), column)
    return n


@_kernel
def _least_radius(s):
    """The least radius of curvature of the surface: the square of the shortest semi-axis over the longest."""
    shortest, longest = _extremes(s)
    return shortest**2 / longest


@_kernel
def _extremes(s):
    """The shortest and the longest semi-axis: the lengths of the columns of S."""
    shortest, longest = np.inf, 0.0
    for j in range(3):
        length = sqrt(s[0, j] ** 2 + s[1, j] ** 2 + s[2, j] ** 2)
        shortest, longest = min(shortest, length), max(longest, length)
    return shortest, longest


@_kernel
def _plane_gap(n, c, a, b):
    v, w = turned_back(a, n), turned_back(b, n)
    return dot(n, c) - sqrt(dot(v, v)) - sqrt(dot(w, w))


@_kernel
def _farthest(s, n):
    """The point of the surface that is farthest in direction n, from the centre."""
    return turned(s, unit(turned_back(s, n)))


@_kernel
def _blend(a, b, share):
    """The six entries of (1 - share) S_a S_aᵀ + share S_b S_bᵀ, by rows."""
    return (
        _entry(a, b, share, 0, 0),
        _entry(a, b, share, 0, 1),
        _entry(a, b, share, 0, 2),
        _entry(a, b, share, 1, 1),
        _entry(a, b, share, 1, 2),
        _entry(a, b, share, 2, 2),
    )


@_kernel
def _entry(a, b, share, i, k):
    total = 0.0
    for j in range(3):
        total += (1.0 - share) * a[i, j] * a[k, j] + share * b[i, j] * b[k, j]
    return total


@_kernel
def _solve(m, c):
    """The solution of a symmetric system of three, up to a positive factor, from its cofactors."""
    xx, xy, xz, yy, yz, zz = m
    row = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy)
    return (
        row[0] * c[0] + row[1] * c[1] + row[2] * c[2],
        row[1] * c[0] + (xx * zz - xz * xz) * c[1] + (xy * xz - xx * yz) * c[2],
        row[2] * c[0] + (xy * xz - xx * yz) * c[1] + (xx * yy - xy * xy) * c[2],
    )


@_kernel
def _tangents(n):
    """Two unit vectors across n and each other; the first lies in the plane z = 0 if n does."""
    x, y, z = abs(n[0]), abs(n[1]), abs(n[2])
    if (z <= x and z <= y) or n[2] == 0.0:
        t = unit((-n[1], n[0], 0.0))
    elif y <= x:
        t = unit((n[2], 0.0, -n[0]))
    else:
        t = unit((0.0, -n[2], n[1]))
    return t, cross(n, t)
