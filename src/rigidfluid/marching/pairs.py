"""The nearest points of two surfaces, exact to their facets, from the field of one of them. Arrays in, arrays out.

The trees of facets are those of `rigidfluid.core.geometry.facet_tree`.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from rigidfluid.core.geometry.facet_tree import search_to_facet
from rigidfluid.core.geometry.simplices import facet_to_facet
from rigidfluid.marching.band import square_length
from rigidfluid.marching.walk import local_search_to_facet
from rigidfluid.marching.workspace import KNOWN


@njit(cache=True, nogil=True)
def any_near(points, facets, chosen, centre, radius):
    """Tell whether the bounding box of one of the facets ``chosen`` meets a ball."""
    nearest = np.inf
    for facet in chosen:
        nearest = min(nearest, _box_to_point(points, facets[facet], centre))
    return nearest <= radius * radius


@njit(cache=True, nogil=True)
def facet_gaps(field, ball, chosen, reach, all_places):
    """Distance of each facet of ``chosen`` to the target of a field, inside a ``ball``, its centre and radius.

    The gap (c,) is infinite where it is above ``reach`` (or, unless ``all_places``, above that of another facet), and
    the partner (c,) the facet where it is reached. A facet with no corner in the band is left out; so is one that
    its distance to the ball, or its corners' distances less its edges, show to be too far.
    """
    (points, surfaces, _, _), (centre, radius) = field.target, ball
    gap = np.empty(len(chosen))  # a lower bound until it is known
    partner = np.empty(len(chosen), np.int32)
    if len(chosen) == 0:
        return gap, partner
    first, nearest_corner = 0, np.inf
    for row in range(len(chosen)):
        gap[row] = sqrt(_box_to_point(points, surfaces.facets[chosen[row]], centre)) - radius
        if gap[row] <= reach:
            by_corners, corner_gap = _bounds(points, surfaces.facets[chosen[row]], field.work)
            gap[row] = max(gap[row], by_corners)
            if corner_gap < nearest_corner:
                first, nearest_corner = row, corner_gap
    limit = reach if all_places else min(reach, nearest_corner)
    # the most promising one first, so that few others are left
    for k in range(-1, len(chosen)):
        row = first if k < 0 else k
        if gap[row] > limit:
            gap[row] = np.inf
        elif k != first:
            gap[row], partner[row] = _facet_gap(field, chosen[row])
            if gap[row] > limit:
                gap[row] = np.inf
            elif not all_places:
                limit = gap[row]
    return gap, partner


@njit(cache=True, nogil=True)
def _bounds(points, corners, work):
    """A lower bound of a facet's distance, and that of its nearest corner; infinite without a corner in the band."""
    least, nearest = np.inf, np.inf
    for corner in corners:
        if work.state[corner] == KNOWN:
            distance = sqrt(work.key[corner])
            edge = 0.0
            for other in corners:
                edge = max(edge, sqrt(square_length(points, corner, other)))
            bound = max(distance - edge, 0.0)
            least = bound if least == np.inf else max(least, bound)
            nearest = min(nearest, distance)
    return least, nearest


@njit(cache=True, nogil=True)
def _facet_gap(field, facet):
    """The distance of a facet, and the facet where it is reached, walking from the one nearest to a corner."""
    (points, surfaces, wanted, tree), work = field.target, field.work
    nearest, start = np.inf, -1
    for corner in surfaces.facets[facet]:
        if work.state[corner] == KNOWN and work.key[corner] < nearest:
            nearest, start = work.key[corner], work.facet[corner]
    square, partner = local_search_to_facet(points, facet, surfaces, wanted, start)
    square, partner = search_to_facet(points, facet, tree, square, partner)
    return sqrt(square), partner


@njit(cache=True, nogil=True)
def nearest_points(points, facets, first, second):
    """The nearest points (c, d) on the facets ``first`` (c,) and on those ``second`` (c,), pair by pair."""
    on_first, on_second = np.zeros((2, len(first), points.shape[1]))
    for pair in range(len(first)):
        found = facet_to_facet(points, facets, first[pair], second[pair])
        for i in range(points.shape[1]):
            for k in range(points.shape[1]):
                on_first[pair, k] += found[1 + i] * points[facets[first[pair], i], k]
                on_second[pair, k] += found[4 + i] * points[facets[second[pair], i], k]
    return on_first, on_second


@njit(cache=True, nogil=True)
def places(facets, chosen):
    """Number (c,) of the patch that each facet of ``chosen`` (c,) is in, connected by shared vertices."""
    patch = np.full(len(chosen), -1, np.int64)
    count = 0
    for row in range(len(chosen)):
        if patch[row] >= 0:
            continue
        patch[row] = count
        waiting = [row]
        while len(waiting) > 0:
            reached = waiting.pop()
            for other in range(len(chosen)):
                if patch[other] < 0 and _share_vertex(facets, chosen[reached], chosen[other]):
                    patch[other] = count
                    waiting.append(other)
        count += 1
    return patch


@njit(cache=True, nogil=True)
def _share_vertex(facets, first, second):
    for i in facets[first]:
        for j in facets[second]:
            if i == j:
                return True
    return False


@njit(cache=True, nogil=True)
def _box_to_point(points, corners, centre):
    """Squared distance of a point to the box around a facet."""
    total = 0.0
    for k in range(points.shape[1]):
        low = high = points[corners[0], k]
        for corner in corners:
            low, high = min(low, points[corner, k]), max(high, points[corner, k])
        total += max(low - centre[k], centre[k] - high, 0.0) ** 2
    return total
