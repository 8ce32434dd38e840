"""Rotational factor of a body: its inverse mass at a surface point over that at the centre of mass, less one."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.body import Body

ELLIPSOIDS = 5.0
"""Bound of the rotational factor of homogeneous ellipsoids, however slender."""

_SAMPLES = 1000


def largest_rotational_factor(body: Body) -> float:
    """Greatest m (r × n)·I⁻¹(r × n) for points r of the surface and any unit n, as at corners; 0 for balls [1].

    The inverse effective mass at a surface point is at most 1 + this over the mass.
    """
    if body.radius is not None:
        return 0.0
    if body.semi_axes is not None:
        return ELLIPSOIDS
    if body.dimension == 2:
        return float(body.bounding_radius**2 / body.unit_inertia[0, 0])
    return rotational_factor_at(surface_points(body), body.unit_inertia)


def surface_points(body: Body) -> FloatArray:
    """Points (N, d) spread over the surface, as far out as it reaches; the vertices of facets, as the rotational
    factor has its maximum at one of them [length]."""
    if body.facets is not None:
        return body.facets.points
    points = body.sample_surface(_SAMPLES)
    farthest = np.linalg.norm(points, axis=1).max()
    return np.asarray(points * (body.bounding_radius / farthest))  # samples may miss the farthest one


def rotational_factor_at(points: FloatArray, unit_inertia: FloatArray) -> float:
    """Greatest rotational factor at ``points`` (N, d) from the centre of mass [length], for the inertia over mass
    ``unit_inertia`` (k, k) in the same frame [length²]; see `largest_rotational_factor` [1]."""
    if points.shape[1] == 2:
        return float(np.max(np.sum(points**2, axis=1)) / unit_inertia[0, 0])
    across = np.cross(points[:, None, :], np.eye(3)[None])  # rows r × e
    return float(np.linalg.eigvalsh(across @ np.linalg.inv(unit_inertia) @ np.swapaxes(across, 1, 2)).max())
