"""Flat parts of a boundary that may stand for all of their plane."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.facet_surface import FLAT, plane_of
from rigidfluid.core.model.facets import Facets
from rigidfluid.core.model.surface import Plane
from rigidfluid.core.model.types import FloatArray


def plane_around(facets: Facets, points: FloatArray) -> Plane | None:
    """The plane of all ``facets`` if they lie in one, and all ``points`` (N, d) of the domain on its one side.

    Where the domain is on both sides of it, as at a corner that points inwards, the plane goes on inside: then the
    facets alone are the wall.
    """
    tolerance = FLAT * float(np.ptp(points, axis=0).max())
    plane = plane_of(facets, tolerance)
    return plane if plane is not None and np.all(plane.signed_distance(points) >= -tolerance) else None
