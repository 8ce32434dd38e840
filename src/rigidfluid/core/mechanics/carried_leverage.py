"""How easily bodies give way at their surfaces, components of mechanisms as the whole does there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.mechanics.leverage import leverage_at, most_leverage, surface_points
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray, Pose

_TIMES = 33
"""How often a mechanism that changes its shape is looked at."""


def leverages(bodies: Sequence[Body], carried: CarriedBodies | None, end: float) -> FloatArray:
    """Mass of all that moves with a body times (r × n)·I⁻¹(r × n) at most on its surface, as in `most_leverage`.

    Parameters
    ----------
    bodies : sequence of Body
        The n shapes.
    carried : CarriedBodies or None
        Their motions, None where each moves by itself.
    end : float
        Until when mechanisms are looked at that change their shape [time].

    Returns
    -------
    (n,) array
        [1].
    """
    alone = np.array([most_leverage(body) for body in bodies])
    if carried is None:
        return alone
    times = np.linspace(0.0, end, _TIMES) if carried.driven else np.zeros(1)
    together = np.max([_within(bodies, carried, time) for time in times], axis=0)
    return np.asarray(np.maximum(alone, together))


def _within(bodies: Sequence[Body], carried: CarriedBodies, time: float) -> FloatArray:
    """In mechanisms at one time, zero for bodies that move by themselves (n,)."""
    motions = Pose(np.zeros_like(carried.pose.position), np.zeros_like(carried.pose.orientation))
    motions.orientation[:, : motions.orientation.shape[1] - 3] = 1.0  # a quaternion's scalar; nothing in 2D
    pose, inertia = carried.poses(motions, time), carried.inertia(time)
    found = np.zeros(len(bodies))
    for body in np.flatnonzero(np.bincount(carried.carrier)[carried.carrier] > 1).tolist():
        motion = carried.carrier[body]
        points = to_world(pose, body, surface_points(bodies[body]))
        found[body] = leverage_at(points, inertia[motion] / carried.mass[motion])
    return found
