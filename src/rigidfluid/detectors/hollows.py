"""Hollows of a surface of facets, whose sides a point leaves one after the other."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.ridges import ridges_of

_LEVEL = -1e-9
"""Height of a facet over the plane of its neighbour, over their size, from which on it does not fall away from it."""


def hollow_numbers(surface: FacetSurface) -> IntArray:
    """Number (F,) of the hollow that each facet is in: that of all neighbours that rise from it by less than a right
    angle, and of theirs.

    The foot of a point on such a facet reaches the end of the facet while the point is still in the fluid, where it is
    nearer to the neighbour.
    """
    first, second = _neighbours(surface.facets.vertices)
    points, normal = surface.facets.points[surface.facets.vertices], surface.facet_normals
    height = np.sum((points[second].mean(axis=1) - points[first].mean(axis=1)) * normal[first], axis=1)
    size = np.linalg.norm(points[second].mean(axis=1) - points[first].mean(axis=1), axis=1)
    along = np.sum(normal[first] * normal[second], axis=1)
    inside = (height >= _LEVEL * size) & (along > -_LEVEL)
    number, first, second = np.arange(len(points)), first[inside], second[inside]
    while np.any(number[first] != number[second]):
        least = np.minimum(number[first], number[second])
        np.minimum.at(number, first, least)
        np.minimum.at(number, second, least)
    return number


def _neighbours(vertices: IntArray) -> tuple[IntArray, IntArray]:
    """Both facets (R,) at each ridge that two share."""
    ridges = ridges_of(vertices)
    at = ridges.number.ravel()
    order = np.argsort(at, kind="stable")
    pairs = order[np.repeat(ridges.facets_at == 2, ridges.facets_at)].reshape(-1, 2) // vertices.shape[1]
    return pairs[:, 0], pairs[:, 1]
