"""The motion of bodies that the fluid cannot move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.model.state import Prescription
from rigidfluid.core.model.types import Pose
from rigidfluid.core.scene.body_tables import PrescribedTable

if TYPE_CHECKING:
    from rigidfluid.core.setup.rigid_body import RigidBody


@dataclass(frozen=True)
class PrescribedMotion:
    """Evaluates a `Prescription`: velocity(t) = before + (twist - before) min(s/over, 1) + 2π f · amplitude ·
    cos(2π f t), s the time since its start."""

    rows: Prescription

    def pose_at(self, time: float) -> Pose:
        """Prescribed poses at ``time``, in closed form, so that no errors of steps add up."""
        rows, d = self.rows, self.rows.amplitude.shape[1]
        elapsed = time - rows.start
        phase = np.sin(2 * np.pi * rows.frequency * time) - np.sin(2 * np.pi * rows.frequency * rows.start)
        changing = np.minimum(elapsed, rows.over)[:, None]
        mean = rows.before + 0.5 * changing / _divisor(rows.over)[:, None] * (rows.twist - rows.before)
        first, then = changing * mean, (elapsed[:, None] - changing) * rows.twist
        moved = first[:, :d] + then[:, :d] + phase[:, None] * rows.amplitude
        return Pose(rows.pose.position + moved, rotate(rotate(rows.pose.orientation, first[:, d:]), then[:, d:]))

    def __call__(self, time: float) -> FloatArray:
        """Velocity and angular velocity (n, d+k) at ``time`` [length/time, rad/time]."""
        rows = self.rows
        lacking = np.maximum(rows.over - (time - rows.start), 0.0) / _divisor(rows.over)
        twist = rows.twist - lacking[:, None] * (rows.twist - rows.before)
        omega = 2 * np.pi * rows.frequency
        twist[:, : rows.amplitude.shape[1]] += (omega * np.cos(omega * time))[:, None] * rows.amplitude
        return twist

    def changed(self, row: int, twist: FloatArray, time: float, over: float = 0.0) -> PrescribedMotion:
        """The same, but for one ``row``, which has the constant ``twist`` (d+k,) from ``time`` + ``over`` on, to which
        it goes linearly from what it has at ``time``."""
        rows, now, pose = self.rows, self(time), self.pose_at(time)
        changed = Prescription(
            twist=_replace_row(rows.twist, row, twist),
            before=_replace_row(rows.before, row, now[row]),
            over=_replace_row(rows.over, row, over),
            amplitude=_replace_row(rows.amplitude, row, 0.0),
            frequency=_replace_row(rows.frequency, row, 0.0),
            start=_replace_row(rows.start, row, time),
            pose=Pose(
                _replace_row(rows.pose.position, row, pose.position[row]),
                _replace_row(rows.pose.orientation, row, pose.orientation[row]),
            ),
        )
        return PrescribedMotion(changed)


def _divisor(over: FloatArray) -> FloatArray:
    """The same where it is not zero."""
    return np.where(over > 0.0, over, 1.0)


def _replace_row(rows: FloatArray, row: int, values: FloatArray | float) -> FloatArray:
    changed = rows.copy()
    changed[row] = values
    return changed


def prescribed_motion(bodies: Sequence[RigidBody], pose: Pose, start: float = 0.0) -> PrescribedMotion:
    """The motion that is prescribed to ``bodies``, the first of those that are at ``pose`` at the ``start``."""
    n, d = pose.position.shape
    twist, amplitude, frequency = np.zeros((n, 3 if d == 2 else 6)), np.zeros((n, d)), np.zeros(n)
    for i, body in enumerate(bodies):
        motion = body.prescribed or PrescribedTable()
        twist[i, :d] = motion.velocity or 0.0
        twist[i, d:] = motion.angular_velocity or 0.0
        amplitude[i] = motion.amplitude or 0.0
        frequency[i] = motion.frequency or 0.0
    return PrescribedMotion(Prescription(twist, twist, np.zeros(n), amplitude, frequency, np.full(n, start), pose))
