"""Flat parts of a boundary that may stand for all of their plane."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.facets import Facets, area_vectors
from rigidfluid.core.model.surface import Plane
from rigidfluid.core.model.types import FloatArray

_FLAT = 1e-10
"""Over the size of the domain: points that are less off a plane lie in it."""


def plane_around(facets: Facets, points: FloatArray) -> Plane | None:
    """The plane of all ``facets`` if they lie in one, and all ``points`` (N, d) of the domain on its one side.

    Where the domain is on both sides of it, as at a corner that points inwards, the plane goes on inside: then the
    facets alone are the wall.
    """
    total = area_vectors(facets.points, facets.vertices).sum(axis=0)
    length = float(np.linalg.norm(total))
    mine, tolerance = facets.points[np.unique(facets.vertices)], _FLAT * float(np.ptp(points, axis=0).max())
    if length <= tolerance:
        return None
    normal = _along_an_axis(total / length)
    plane = Plane(mine[0], normal, (mine.min(axis=0), mine.max(axis=0)))
    flat = np.all(np.abs(plane.signed_distance(mine)) <= tolerance)
    return plane if flat and np.all(plane.signed_distance(points) >= -tolerance) else None


def _along_an_axis(normal: FloatArray) -> FloatArray:
    """The same unit normal, exactly along an axis where it is by rounding."""
    rounded = np.round(normal)
    return rounded if np.all(np.abs(normal - rounded) <= _FLAT) else normal
