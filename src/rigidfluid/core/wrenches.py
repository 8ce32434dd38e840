"""The only place where action = reaction and the moment arm are applied."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.rigid import moment
from rigidfluid.core.types import Contacts, FloatArray, IntArray, Pose, Wrench


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
    """
    wrench, count = nothing(pose), len(pose.position)
    point, on_body = 0.5 * (contacts.point_a + contacts.point_b), contacts.body_b < count
    _apply(wrench, pose, contacts.body_a, point, force_on_a)
    _apply(wrench, pose, contacts.body_b[on_body], point[on_body], -force_on_a[on_body])
    return wrench


def nothing(pose: Pose) -> Wrench:
    """The wrench of no contact at all on bodies at ``pose``."""
    count, dimension = pose.position.shape
    return Wrench(np.zeros((count, dimension)), np.zeros((count, 1 if dimension == 2 else 3)))


def _apply(wrench: Wrench, pose: Pose, body: IntArray, point: FloatArray, force: FloatArray) -> None:
    # ufunc.at, because a body occurs as often as it has contacts
    np.add.at(wrench.force, body, force)
    np.add.at(wrench.torque, body, moment(point - pose.position[body], force))
