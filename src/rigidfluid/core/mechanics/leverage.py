"""How much more easily a body gives way at its surface than at its centre of mass."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray

ELLIPSOIDS = 5.0
"""No homogeneous ellipsoid has more, however slender."""

_SAMPLES = 1000


def most_leverage(body: Body) -> float:
    """Mass times (r × n)·I⁻¹(r × n) at most, for points r of the surface and any unit n, as at corners; 0 for balls.

    Parameters
    ----------
    body : Body
        The shape.

    Returns
    -------
    float
        1/(effective mass) at a point of the surface is at most 1 + this over the mass [1].
    """
    if body.radius is not None:
        return 0.0
    if body.semi_axes is not None:
        return ELLIPSOIDS
    if body.dimension == 2:
        return float(body.bounding_radius**2 / body.unit_inertia[0, 0])
    return leverage_at(surface_points(body), body.unit_inertia)


def surface_points(body: Body) -> FloatArray:
    """Points (N, d) spread over the surface, as far out as it reaches; of facets their vertices, since nothing between
    them gives way more easily [length]."""
    if body.facets is not None:
        return body.facets.points
    points = body.sample_surface(_SAMPLES)
    farthest = np.linalg.norm(points, axis=1).max()
    return np.asarray(points * (body.bounding_radius / farthest))  # samples may miss the farthest one


def leverage_at(points: FloatArray, unit_inertia: FloatArray) -> float:
    """The most at any of some points.

    Parameters
    ----------
    points : (N, d) array
        From the centre of mass [length].
    unit_inertia : (k, k) array
        Of what turns, in the same frame [length²].

    Returns
    -------
    float
        As in `most_leverage` [1].
    """
    if points.shape[1] == 2:
        return float(np.max(np.sum(points**2, axis=1)) / unit_inertia[0, 0])
    across = np.cross(points[:, None, :], np.eye(3)[None])  # rows r × e
    return float(np.linalg.eigvalsh(across @ np.linalg.inv(unit_inertia) @ np.swapaxes(across, 1, 2)).max())
