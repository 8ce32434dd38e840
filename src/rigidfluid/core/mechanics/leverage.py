"""How much more easily a body gives way at its surface than at its centre of mass."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.interfaces import Body

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
    points = body.sample_surface(_SAMPLES)
    points = points * (body.bounding_radius / np.linalg.norm(points, axis=1).max())  # samples may miss the farthest one
    if body.dimension == 2:
        return float(body.bounding_radius**2 / body.unit_inertia[0, 0])
    across = np.cross(points[:, None, :], np.eye(3)[None])  # rows r × e
    return float(np.linalg.eigvalsh(across @ np.linalg.inv(body.unit_inertia) @ np.swapaxes(across, 1, 2)).max())
