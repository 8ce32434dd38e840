"""Puts vertices on all the planes at once that they belong to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.model.surface import Plane
from rigidfluid.core.model.types import BoolArray, FloatArray

_PARALLEL = 1e-6
"""Planes that meet at a smaller angle than about this are taken for one: where they meet, rounding alone would say."""


def put_on_planes(points: FloatArray, planes: Sequence[Plane], belongs: BoolArray) -> FloatArray:
    """The ``points`` (N, d), each on all the planes that it ``belongs`` to, (N, k) [length]."""
    points, rows = points.copy(), np.flatnonzero(belongs.any(axis=1))
    groups, group = np.unique(belongs[rows], axis=0, return_inverse=True)
    for number, mine in enumerate(groups):
        met, chosen = [plane for plane, on in zip(planes, mine, strict=True) if on], rows[group == number]
        points[chosen] = closest_on_all(met, points[chosen])
    return points


def closest_on_all(planes: Sequence[Plane], points: FloatArray) -> FloatArray:
    """Nearest points of the intersection of planes, x - N⁺[N (x - x₀)], (N, d) for ``points`` x (N, d) [length].

    N⁺ is the pseudoinverse of the normals. One plane after the other would leave all but the last. Across an axis the
    coordinate is exactly the plane's.
    """
    if any(plane.axis is None for plane in planes):
        normals = np.array([plane.unit_normal for plane in planes])
        distances = np.stack([plane.signed_distance(points) for plane in planes], axis=1)
        points = points - distances @ np.linalg.pinv(normals, rcond=_PARALLEL).T
    for plane in planes:
        if plane.axis is not None:
            points = plane.closest_point(points)
    return points
