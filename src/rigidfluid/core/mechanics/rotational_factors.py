"""Rotational factor of bodies, that of the whole mechanism for its components."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.frames import to_world
from rigidfluid.core.mechanics.rotational_factor import largest_rotational_factor, rotational_factor_at, surface_points
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.types import Pose

_TIMES = 33
"""Number of times at which a mechanism that changes its shape is sampled."""


def rotational_factors(bodies: Sequence[Body], motions: Motions, end: float) -> FloatArray:
    """Greatest m (r × n)·I⁻¹(r × n) on each surface (n,), with m and I of the body alone or of the motion that carries
    it, whichever gives more [1]; mechanisms that change their shape are sampled until ``end`` [time]."""
    alone = np.array([largest_rotational_factor(body) for body in bodies])
    times = np.linspace(0.0, end, _TIMES) if motions.driven else np.zeros(1)
    together = np.max([_within(bodies, motions, time) for time in times], axis=0)
    return np.asarray(np.maximum(alone, together))


def _within(bodies: Sequence[Body], carried: Motions, time: float) -> FloatArray:
    """Rotational factor of each body as part of its mechanism at one time (n,), zero for bodies that move by themselves
    [1]."""
    motions = Pose(np.zeros_like(carried.pose.position), np.zeros_like(carried.pose.orientation))
    motions.orientation[:, : motions.orientation.shape[1] - 3] = 1.0  # a quaternion's scalar; nothing in 2D
    pose, inertia = carried.poses(motions, time), carried.inertia(time)
    found = np.zeros(len(bodies))
    for body in np.flatnonzero(np.bincount(carried.carrier)[carried.carrier] > 1).tolist():
        motion = carried.carrier[body]
        points = to_world(pose, body, surface_points(bodies[body]))
        found[body] = rotational_factor_at(points, inertia[motion] / carried.mass[motion])
    return found
