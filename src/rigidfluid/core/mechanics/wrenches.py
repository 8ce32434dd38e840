"""The only place where action = reaction and the moment arm are applied."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.part_results import refuse_lost_forces
from rigidfluid.core.model.types import Contacts, FloatArray, Pose, Twist, Wrench


def contact_wrench(contacts: Contacts, force_on_a: FloatArray, pose: Pose) -> Wrench:
    """Net wrench of all contacts on each body, +F on a and -F on b, both at X = (X_a + X_b)/2, torque (X - x) × F.

    At one point, so that forces along the surfaces as well leave the total angular momentum as it is.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    force_on_a : (m, d) array
        Force F on ``body_a`` [force].
    pose : Pose
        Pose of the n bodies, x the positions.

    Returns
    -------
    Wrench
        Force and torque on the n bodies; what a wall takes is dropped.

    Raises
    ------
    PluginError, StepRejected
        If the force has another shape, or is no number.
    """
    wrench = nothing(pose)
    if len(contacts):
        from rigidfluid.core.mechanics.contact_sum import accumulate

        refuse_lost_forces(contacts, force_on_a)
        a, b = (contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)
        accumulate(wrench.force, wrench.torque, pose.position, *a, *b, force_on_a)
    return wrench


def nothing(pose: Pose) -> Wrench:
    """The wrench of no contact at all on bodies at ``pose``."""
    count, dimension = pose.position.shape
    return Wrench(np.zeros((count, dimension)), np.zeros((count, 1 if dimension == 2 else 3)))


def flat(record: Wrench | Twist) -> FloatArray:
    """Force and torque, or velocity and angular velocity, side by side, (n, d+k)."""
    pair = (record.force, record.torque) if isinstance(record, Wrench) else (record.velocity, record.angular_velocity)
    return np.concatenate(pair, axis=1)


def wrench_of(rows: FloatArray, dimension: int) -> Wrench:
    """Force and torque of rows (n, d+k)."""
    return Wrench(rows[:, :dimension], rows[:, dimension:])


def together(one: Wrench, other: Wrench) -> Wrench:
    """Their sum."""
    return Wrench(one.force + other.force, one.torque + other.torque)


def power(wrench: Wrench, twist: Twist) -> FloatArray:
    """F·U + T·ω of each body, (n,) [energy/time]."""
    return np.asarray(
        np.sum(wrench.force * twist.velocity, axis=1) + np.sum(wrench.torque * twist.angular_velocity, axis=1)
    )
