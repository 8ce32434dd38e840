"""Local minima of the distance between ellipsoids and facets, by a compiled loop over the ellipsoids.

All vectors are triples: in the plane the third component is zero, and a third semi-axis, as long as the longest,
changes nothing.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from math import copysign, sqrt

import numpy as np
from numba import njit

from rigidfluid.detectors.triples import cross, dot, less, plus, times, triple, turned, turned_back, unit

_BISECTIONS = 60
_MOST_STEPS = 1000
_EPSILON = float(np.finfo(float).eps)
_SMALLEST = 1e-100
"""Least distance from the plane across the shortest axis, over that axis: on it the nearest point may lie off it."""

_UPHILL = -1e-9
"""Slope of a distance along a straight line that is zero but for rounding [1]."""

_kernel = njit(cache=True, nogil=True, error_model="numpy")


@_kernel
def distance_minima(position, rotation, axes, facets, reach, same):
    """Minima of the distance to each of some ellipsoids on a surface of facets: inside facets, at corners, and in space
    on edges; each place once, as on the edge of two facets it may be found in both.

    ``position`` (n, 3) [length], ``rotation`` (n, 3, 3) and semi-axes ``axes`` (n, 3) [length] of the ellipsoids in the
    frame of the surface, whose ``facets`` are `FacetTriples`; the largest distance, ``reach`` [length]; and the
    distance (n,) below which two places are the ``same`` [length]. Returns the row (m,) of the ellipsoid, the place on
    the surface (m, 3), the signed distance (m,), the normal (m, 3) from there to the ellipsoid, and whether each
    ellipsoid (n,) has such a place at any distance.
    """
    found = [(0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) for _ in range(0)]
    is_near, slope = np.zeros(len(facets.points), np.bool_), np.empty(len(facets.points))
    outwards, away = np.empty((len(facets.points), 3)), np.empty(len(facets.points))
    kept, has_place = found.copy(), np.empty(len(position), np.bool_)
    for row in range(len(position)):
        body = (triple(position[row]), rotation[row], axes[row])
        found.clear()
        _add_inside_facets(found, row, body, facets)
        _add_corners(found, row, body, facets, reach, is_near, slope, outwards, away)
        _add_edges(found, row, body, facets, reach)
        has_place[row] = len(found) > 0
        _keep_distinct(kept, found, reach, same[row])
    rows, distance = np.empty(len(kept), np.int64), np.empty(len(kept))
    foot, normal = np.empty((len(kept), 3)), np.empty((len(kept), 3))
    for i in range(len(kept)):
        rows[i], distance[i], here, up = kept[i]
        for k in range(3):
            foot[i, k], normal[i, k] = here[k], up[k]
    return rows, foot, distance, normal, has_place


@_kernel
def _keep_distinct(kept, found, reach, same):
    """Append to those ``kept`` the places of one ellipsoid within reach, the nearest first, and none beside one
    before."""
    first = len(kept)
    for place in np.argsort(np.array([distance for _, distance, _, _ in found]), kind="mergesort"):
        _, distance, foot, _ = found[place]
        beside = not distance <= reach
        for i in range(first, len(kept)):
            apart = less(kept[i][2], foot)
            beside |= sqrt(dot(apart, apart)) <= same
        if not beside:
            kept.append(found[place])


@_kernel
def _add_inside_facets(found, row, body, facets):
    """Add the places inside facets before the centre, opposite to where the ellipsoid is farthest against their
    normal."""
    dimension = facets.vertices.shape[1]
    for facet in range(len(facets.vertices)):
        normal, first = triple(facets.normals[facet]), triple(facets.points[facets.vertices[facet, 0]])
        if not dot(less(body[0], first), normal) > 0.0:
            continue
        nearest = _farthest(body, times(-1.0, normal))
        height = dot(less(nearest, first), normal)
        foot, inside = less(nearest, times(height, normal)), True
        for i in range(dimension):
            corner = triple(facets.points[facets.vertices[facet, i]])
            edge = less(triple(facets.points[facets.vertices[facet, (i + 1) % dimension]]), corner)
            inwards = cross(normal, edge) if dimension == 3 else edge
            inside &= dot(inwards, less(foot, corner)) >= _UPHILL * dot(edge, edge)
        if inside:
            found.append((row, height, foot, normal))


@_kernel
def _add_corners(found, row, body, facets, reach, is_near, slope, outwards, away):
    """Add the corners from which the distance falls along no edge; the last four arguments are room for one value at
    each point."""
    any_near = False
    size = max(body[2][0], body[2][1], body[2][2])
    for corner in facets.corners:
        arm = less(triple(facets.points[corner]), body[0])
        is_near[corner] = sqrt(dot(arm, arm)) - size <= reach
        if is_near[corner]:
            any_near, slope[corner] = True, np.inf
            away[corner], normal = _measured(body, arm)
            for k in range(3):
                outwards[corner, k] = normal[k]
    if not any_near:
        return
    for edge in range(len(facets.all_edges)):
        for end in range(2):
            start, stop = facets.all_edges[edge, end], facets.all_edges[edge, 1 - end]
            if is_near[start]:
                along = less(triple(facets.points[stop]), triple(facets.points[start]))
                rise = dot(along, triple(outwards[start])) / sqrt(dot(along, along))
                slope[start] = min(slope[start], rise)
    for corner in facets.corners:
        if is_near[corner] and slope[corner] >= _UPHILL:
            towards = times(-1.0, triple(outwards[corner]))
            found.append((row, away[corner], triple(facets.points[corner]), towards))


@_kernel
def _add_edges(found, row, body, facets, reach):
    """Add the places inside edges from which the distance falls into neither facet; in the plane there are none."""
    size = max(body[2][0], body[2][1], body[2][2])
    for edge in range(len(facets.edges)):
        start, end = triple(facets.points[facets.edges[edge, 0]]), triple(facets.points[facets.edges[edge, 1]])
        along = less(end, start)
        middle = less(plus(start, 0.5, along), body[0])
        if sqrt(dot(middle, middle)) - 0.5 * sqrt(dot(along, along)) - size > reach:
            continue
        low, high = 0.0, 1.0
        for _ in range(_BISECTIONS):
            at = 0.5 * (low + high)
            if dot(_measured(body, less(plus(start, at, along), body[0]))[1], along) > 0.0:
                high = at
            else:
                low = at
        place = plus(start, 0.5 * (low + high), along)
        distance, normal = _measured(body, less(place, body[0]))
        lowest = low > 0.0 and high < 1.0
        for side in range(2):
            lowest &= dot(triple(facets.downhill[edge, side]), normal) >= _UPHILL
        if lowest:
            found.append((row, distance, place, times(-1.0, normal)))


@_kernel
def _measured(body, arm):
    """Signed distance of the point that is ``arm`` away from the centre, and the outward normal at its nearest point,
    see `ellipsoid_distance`."""
    rotation, axes = body[1], body[2]
    local = turned_back(rotation, arm)
    shortest = 0
    for k in range(1, 3):
        if axes[k] < axes[shortest]:
            shortest = k
    ratios = ((axes[0] / axes[shortest]) ** 2, (axes[1] / axes[shortest]) ** 2, (axes[2] / axes[shortest]) ** 2)
    numerator = (
        _off_its_plane(local[0], axes[0], shortest == 0) * ratios[0],
        _off_its_plane(local[1], axes[1], shortest == 1) * ratios[1],
        _off_its_plane(local[2], axes[2], shortest == 2) * ratios[2],
    )
    image = unit(_image(numerator, (ratios[0] - 1.0, ratios[1] - 1.0, ratios[2] - 1.0)))
    foot = (
        copysign(axes[0] * image[0], local[0]),
        copysign(axes[1] * image[1], local[1]),
        copysign(axes[2] * image[2], local[2]),
    )
    normal = unit((foot[0] / axes[0] ** 2, foot[1] / axes[1] ** 2, foot[2] / axes[2] ** 2))
    return dot(less(local, foot), normal), turned(rotation, normal)


@_kernel
def _off_its_plane(component, axis, is_shortest):
    """Size of a component over its semi-axis, not zero along the shortest."""
    scaled = abs(component) / axis
    return max(scaled, _SMALLEST) if is_shortest else scaled


@_kernel
def _image(numerator, shift):
    """Image of the largest root of one secular equation, see `secular_image`."""
    root = max(numerator[0] - shift[0], numerator[1] - shift[1], numerator[2] - shift[2])
    for _ in range(_MOST_STEPS):
        below = (root + shift[0], root + shift[1], root + shift[2])
        image = (numerator[0] / below[0], numerator[1] / below[1], numerator[2] / below[2])
        square = dot(image, image)
        slope = image[0] ** 2 / below[0] + image[1] ** 2 / below[1] + image[2] ** 2 / below[2]
        newton = square * (sqrt(square) - 1.0) / slope
        if not newton > 4.0 * _EPSILON * root:
            return image
        root += newton
    raise FloatingPointError("the root of a secular equation was not found")


@_kernel
def _farthest(body, direction):
    """Point of the ellipsoid that is farthest in this direction."""
    axes, local = body[2], turned_back(body[1], direction)
    scaled = (axes[0] * local[0], axes[1] * local[1], axes[2] * local[2])
    share = 1.0 / sqrt(dot(scaled, scaled))
    there = (axes[0] * scaled[0] * share, axes[1] * scaled[1] * share, axes[2] * scaled[2] * share)
    return plus(body[0], 1.0, turned(body[1], there))
