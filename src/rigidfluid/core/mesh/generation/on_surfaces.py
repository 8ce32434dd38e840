"""Puts points on all the surfaces at once that they belong to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.surface import Plane, Surface

_PARALLEL = 1e-6
"""Planes that meet at a smaller angle than about this are taken for one: where they meet, rounding alone would say."""

_TANGENT = 0.1
"""The same where a surface is curved, whose distance is not as exact beyond its rim."""

_ROUNDS = 8
"""Newton's steps onto curved surfaces; each squares the error."""


def put_on_surfaces(points: FloatArray, shapes: Sequence[Surface], belongs: BoolArray) -> FloatArray:
    """The ``points`` (N, d), each on all the shapes that it ``belongs`` to, (N, k) [length]."""
    points, rows = points.copy(), np.flatnonzero(belongs.any(axis=1))
    groups, group = np.unique(belongs[rows], axis=0, return_inverse=True)
    for number, mine in enumerate(groups):
        those, chosen = [shape for shape, on in zip(shapes, mine, strict=True) if on], rows[group == number]
        points[chosen] = closest_on_all(those, points[chosen])
    return points


def closest_on_all(shapes: Sequence[Surface], points: FloatArray) -> FloatArray:
    """Points of the intersection of shapes, near ``points`` (N, d), nearest where all are flat, (N, d) [length].

    Curved shapes are reached by Newton's steps onto all tangent planes at once: one shape after the other would leave
    all but the last.
    """
    if len(shapes) == 1:
        return shapes[0].closest_point(points)
    planes = [shape.plane for shape in shapes if shape.plane is not None]
    if len(planes) < len(shapes):
        for _ in range(_ROUNDS):
            feet = np.stack([shape.closest_point(points) for shape in shapes], axis=1)
            normals = np.stack([shape.normal(points) for shape in shapes], axis=1)
            points = _onto(normals, np.sum((points[:, None] - feet) * normals, axis=2), points, _TANGENT)
    return _closest_on_planes(planes, points)


def _closest_on_planes(planes: Sequence[Plane], points: FloatArray) -> FloatArray:
    """The nearest points on all planes; across an axis the coordinate is exactly the plane's."""
    if any(plane.axis is None for plane in planes):
        normals = np.array([[plane.unit_normal for plane in planes]])
        distances = np.stack([plane.signed_distance(points) for plane in planes], axis=1)
        points = _onto(normals, distances, points, _PARALLEL)
    for plane in planes:
        if plane.axis is not None:
            points = plane.closest_point(points)
    return points


def _onto(normals: FloatArray, distances: FloatArray, points: FloatArray, parallel: float) -> FloatArray:
    """x - N⁺ r, the shortest way onto planes of ``normals`` N (N or 1, k, d) at ``distances`` r (N, k)."""
    return np.asarray(points - np.einsum("ndk,nk->nd", np.linalg.pinv(normals, rcond=parallel), distances))
