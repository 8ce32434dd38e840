"""Net wrench of contacts, where alone action = reaction and the moment arm are applied, and arithmetic of wrenches."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.model.types import Contacts, Pose, Twist, Wrench


def contact_wrench(
    contacts: Contacts, force_on_a: FloatArray, pose: Pose, couple_on_a: FloatArray | None = None
) -> Wrench:
    """Net wrench of all contacts on each of the n bodies, +F on a and -F on b, both at X = (X_a + X_b)/2, torque (X -
    x) × F + C on a and the opposite on b, whose x is that of the image met; the wrench on walls is dropped.

    The common point X keeps the total angular momentum, for forces along the surfaces as well. ``force_on_a`` is F on
    ``body_a`` (m, d) [force], ``couple_on_a`` C (m, k), None for none [force·length].
    """
    wrench = nothing(pose)
    if len(contacts):
        from rigidfluid.core.mechanics.contact_sum import accumulate, accumulate_couples

        a, b = (contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)
        accumulate(wrench.force, wrench.torque, pose.position, *a, *b, contacts.shift, force_on_a)
        if couple_on_a is not None:
            accumulate_couples(wrench.torque, contacts.body_a, contacts.body_b, couple_on_a)
    return wrench


def add_pair_wrench(wrench: Wrench, pose: Pose, pair: tuple[int, int], force: FloatArray, couple: FloatArray) -> None:
    """Add to the ``wrench`` on bodies at ``pose``, in place, a ``force`` (d,) on the first of a ``pair`` at the middle
    between both centres of mass and a ``couple`` (k,), and the opposite of both on the second."""
    centre = 0.5 * (pose.position[pair[0]] + pose.position[pair[1]])
    for sign, body in zip((1.0, -1.0), pair, strict=True):
        wrench.force[body] += sign * force
        wrench.torque[body] += sign * (moment((centre - pose.position[body])[None], force[None])[0] + couple)


def nothing(pose: Pose) -> Wrench:
    """Zero wrench on bodies at ``pose``."""
    count, dimension = pose.position.shape
    return Wrench(np.zeros((count, dimension)), np.zeros((count, 1 if dimension == 2 else 3)))


def flat(record: Wrench | Twist) -> FloatArray:
    """Rows (n, d+k) of force and torque, or of velocity and angular velocity, side by side."""
    pair = (record.force, record.torque) if isinstance(record, Wrench) else (record.velocity, record.angular_velocity)
    return np.concatenate(pair, axis=1)


def wrench_of(rows: FloatArray, dimension: int) -> Wrench:
    """Wrench of rows (n, d+k)."""
    return Wrench(rows[:, :dimension], rows[:, dimension:])


def wrench_sum(one: Wrench, other: Wrench) -> Wrench:
    """Sum of two wrenches."""
    return Wrench(one.force + other.force, one.torque + other.torque)


def power(wrench: Wrench, twist: Twist) -> FloatArray:
    """Power F·U + T·ω of each body, (n,) [energy/time]."""
    return np.asarray(
        np.sum(wrench.force * twist.velocity, axis=1) + np.sum(wrench.torque * twist.angular_velocity, axis=1)
    )
