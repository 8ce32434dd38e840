"""The only place where action = reaction and the moment arm are applied."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.rigid import moment
from rigidfluid.core.types import Contacts, FloatArray, IntArray, Pose, Wrench


def contact_wrench(contacts: Contacts, force_on_a: FloatArray, pose: Pose) -> Wrench:
    """Net wrench of all contacts on each body, +F at point_a on a and -F at point_b on b, torque (point - x) × F.

    Parameters
    ----------
    contacts : Contacts
        The m contacts.
    force_on_a : (m, d) array
        Force F on ``body_a`` at ``point_a`` [force].
    pose : Pose
        Pose of the n bodies, x the positions.

    Returns
    -------
    Wrench
        Force and torque on the n bodies; what a wall takes is dropped.
    """
    count, dimension = pose.position.shape
    wrench = Wrench(np.zeros((count, dimension)), np.zeros((count, 1 if dimension == 2 else 3)))
    on_body = contacts.body_b < count
    _apply(wrench, pose, contacts.body_a, contacts.point_a, force_on_a)
    _apply(wrench, pose, contacts.body_b[on_body], contacts.point_b[on_body], -force_on_a[on_body])
    return wrench


def _apply(wrench: Wrench, pose: Pose, body: IntArray, point: FloatArray, force: FloatArray) -> None:
    # ufunc.at, because a body occurs as often as it has contacts
    np.add.at(wrench.force, body, force)
    np.add.at(wrench.torque, body, moment(point - pose.position[body], force))
