"""The motion of bodies that the fluid cannot move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.model.types import FloatArray, Pose

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import Scene


@dataclass(frozen=True)
class PrescribedMotion:
    """Constant twists and sinusoidal displacements, zero for bodies that are free or fixed.

    velocity(t) = velocity + 2π f · amplitude · cos(2π f t)

    Parameters
    ----------
    twist : ndarray (n, d+k)
        Constant velocity and angular velocity [length/time, rad/time].
    amplitude : ndarray (n, d)
        Amplitude of the displacement [length].
    frequency : ndarray (n,)
        Its frequency f [1/time].
    pose : Pose
        Of all bodies when the motion starts.
    start : float
        When that is [time].
    """

    twist: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    pose: Pose
    start: float

    def pose_at(self, time: float) -> Pose:
        """Where the motion leads to by ``time``: evaluated, so that no error of a step adds up."""
        elapsed, d = time - self.start, self.amplitude.shape[1]
        phase = np.sin(2 * np.pi * self.frequency * time) - np.sin(2 * np.pi * self.frequency * self.start)
        moved = elapsed * self.twist[:, :d] + phase[:, None] * self.amplitude
        return Pose(self.pose.position + moved, rotate(self.pose.orientation, elapsed * self.twist[:, d:]))

    def __call__(self, time: float) -> FloatArray:
        """Velocity and angular velocity (n, d+k) at ``time`` [length/time, rad/time]."""
        twist = self.twist.copy()
        omega = 2 * np.pi * self.frequency
        twist[:, : self.amplitude.shape[1]] += (omega * np.cos(omega * time))[:, None] * self.amplitude
        return twist


def prescribed_motion(scene: Scene, pose: Pose, start: float = 0.0) -> PrescribedMotion:
    """The motion that a scene prescribes to its bodies, the first of those that are at ``pose`` at time ``start``."""
    n, d = len(pose.position), scene.dimension
    twist, amplitude, frequency = np.zeros((n, 3 if d == 2 else 6)), np.zeros((n, d)), np.zeros(n)
    for i, body in enumerate(scene.body):
        motion = body.prescribed
        if motion is None:
            continue
        twist[i, :d] = motion.velocity or 0.0
        twist[i, d:] = motion.angular_velocity or 0.0
        amplitude[i] = motion.amplitude or 0.0
        frequency[i] = motion.frequency or 0.0
    return PrescribedMotion(twist, amplitude, frequency, pose, start)
