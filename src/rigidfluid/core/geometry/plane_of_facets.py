"""Flat parts of a boundary that may stand for all of their plane."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.surface import Plane

FLAT = 1e-10
"""Distance from a plane, over the size of the surface, below which points lie in it."""


def plane_around(facets: Facets, points: FloatArray) -> Plane | None:
    """Plane of all ``facets`` if they lie in one, and all ``points`` (N, d) of the domain on its one side.

    If the domain is on both sides of it, as at a corner that points inwards, the plane goes on inside: then the facets
    alone are the wall.
    """
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    plane = _plane_of(facets, tolerance)
    return plane if plane is not None and np.all(plane.signed_distance(points) >= -tolerance) else None


def _plane_of(facets: Facets, tolerance: float) -> Plane | None:
    """The plane that all facets lie in but for a ``tolerance`` [length], bounded as they are; None if there is none.

    A normal that lies along an axis but for rounding is put there.
    """
    vectors = area_vectors(facets.points, facets.vertices)
    total = vectors.sum(axis=0)
    length = float(np.linalg.norm(total))
    if length <= FLAT * np.linalg.norm(vectors, axis=1).sum():
        return None
    normal, rounded = total / length, np.round(total / length)
    if np.all(np.abs(normal - rounded) <= FLAT):
        normal = rounded
    mine = facets.points[np.unique(facets.vertices)]
    plane = Plane(facets.points[facets.vertices[0, 0]], normal, (mine.min(axis=0), mine.max(axis=0)))
    return plane if np.all(np.abs(plane.signed_distance(mine)) <= tolerance) else None
