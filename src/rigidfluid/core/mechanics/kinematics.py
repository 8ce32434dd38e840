"""Kinematics of bodies that motions carry: body twist = G u + g, motion wrench = Gᵀ body wrench."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import cross, moment
from rigidfluid.core.model.types import Pose, Step, Twist, Wrench


@dataclass(frozen=True, slots=True)
class CarriedKinematics:
    """Kinematics of n components on N motions at one moment.

    Component i is carried by motion ``carrier[i]`` (n,), whose centre of mass is at ``centre`` (N, d); ``arm`` (n, d)
    leads from there to the component's [length]. (G u)ᵢ = (U + ω × armᵢ, ω) of the motion's velocities u = (U, ω).
    ``relative_twist`` (n, d+k): g, that of relative motion [length/time, rad/time].
    """

    carrier: IntArray
    centre: FloatArray
    arm: FloatArray
    relative_twist: FloatArray

    def centres(self, bodies: Pose) -> FloatArray:
        return self.centre

    def component_twist(self, motion: Twist) -> Twist:
        """Twists of the bodies, Uᵢ = U + ω × armᵢ + gᵢ, ωᵢ = ω + gᵢ."""
        d, spin = self.arm.shape[1], motion.angular_velocity[self.carrier]
        velocity = motion.velocity[self.carrier] + cross(spin, self.arm)
        return Twist(velocity + self.relative_twist[:, :d], spin + self.relative_twist[:, d:])

    def motion_twist(self, twist: FloatArray) -> FloatArray:
        """Twists of the motions, read from the first body of each."""
        d, first = self.arm.shape[1], np.unique(self.carrier, return_index=True)[1]
        free = twist[first] - self.relative_twist[first]
        free[:, :d] -= cross(free[:, d:], self.arm[first])
        return free

    def motion_wrench(self, wrench: Wrench) -> Wrench:
        """Wrench on the motions, F = Σ Fᵢ, T = Σ (armᵢ × Fᵢ + Tᵢ)."""
        torque = wrench.torque + moment(self.arm, wrench.force)
        return Wrench(*(carried_sum(self.carrier, rows, len(self.centre)) for rows in (wrench.force, torque)))

    def motion_rows(self, rows: FloatArray) -> FloatArray:
        d = self.arm.shape[1]
        turning = moment(np.broadcast_to(self.arm, rows[..., :d].shape), rows[..., :d])
        whole = np.concatenate([rows[..., :d], rows[..., d:] + turning], axis=2)
        return np.swapaxes(carried_sum(self.carrier, np.swapaxes(whole, 0, 1), len(self.centre)), 0, 1)

    def has_prescribed_part(self, prescribed: BoolArray, twist: Twist) -> BoolArray:
        """Tell whether the prescribed part is not zero, be it by a prescribed motion or by relative motion."""
        return np.asarray(np.any(twist.velocity, axis=1) | np.any(twist.angular_velocity, axis=1))

    def body_rates(self, rate: FloatArray, motion: Twist, relative_rate: FloatArray) -> FloatArray:
        """Accelerations A + α × arm + ω × (ω × arm) of the motions that carry the bodies, and that of g."""
        d, carrier = self.arm.shape[1], self.carrier
        spin = motion.angular_velocity[carrier]
        turning = cross(rate[carrier, d:], self.arm) + cross(spin, cross(spin, self.arm))
        carried = np.concatenate([rate[carrier, :d] + turning, rate[carrier, d:]], axis=1)
        return np.asarray(carried + relative_rate)


def prescribed_part(step: Step) -> tuple[Twist, BoolArray]:
    """Prescribed part of the bodies' twists in a step, n rows, and whether a body has one (n,)."""
    d = step.pose.position.shape[1]
    motion = np.where(step.prescribed[:, None], step.prescribed_twist, 0.0)
    twist = step.kinematics.component_twist(Twist(motion[:, :d], motion[:, d:]))
    return twist, step.kinematics.has_prescribed_part(step.prescribed, twist)


def carried_sum(carrier: IntArray, rows: FloatArray, motions: int) -> FloatArray:
    """Sum of ``rows`` (n, …) over the bodies that each motion carries, (N, …)."""
    total = np.zeros((motions, *rows.shape[1:]))
    np.add.at(total, carrier, rows)
    return total


def jacobian(kinematics: CarriedKinematics) -> sparse.csr_matrix:
    """Matrix G (n·(d+k), N·(d+k)) from velocities of the motions to those of the bodies."""
    count, d = kinematics.arm.shape
    width = kinematics.relative_twist.shape[1]
    block = np.tile(np.eye(width), (count, 1, 1))
    block[:, :d, d:] = levers(kinematics.arm)
    rows = (width * np.arange(count)[:, None, None] + np.arange(width)[:, None] + np.zeros(width, dtype=int)).ravel()
    columns = (width * kinematics.carrier[:, None, None] + np.zeros((width, 1), dtype=int) + np.arange(width)).ravel()
    shape = count * width, len(kinematics.centre) * width
    return sparse.csr_matrix((block.ravel(), (rows, columns)), shape=shape)


def levers(arm: FloatArray) -> FloatArray:
    """Lever matrices X (n, d, k) with X ω = ω × arm, for arms (n, d) [length]."""
    k = 1 if arm.shape[1] == 2 else 3
    return cross(np.eye(k)[:, None], arm).transpose(1, 2, 0)
