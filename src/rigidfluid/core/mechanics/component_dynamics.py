"""Dynamics of bodies that motions carry, as contacts see them."""

from __future__ import annotations

from copy import copy
from typing import Protocol, Self

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.kinematics import CarriedKinematics, jacobian, levers
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.dynamics import LinkWork, MotionDynamics
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.state import MotionState
from rigidfluid.core.model.types import Pose, Twist, Wrench


class Carried(Protocol):
    """Bodies that motions carry."""

    def poses(self, motions: Pose, time: float) -> Pose:
        """Pose of the bodies, where the ``motions`` are there."""

    def kinematics(self, motions: Pose, time: float) -> CarriedKinematics:
        """G and g, where the ``motions`` are there."""


class ComponentDynamics:
    """Dynamics of n bodies on N ``motions``, changed in place: a kick acts on the motions as Gᵀ of it; poses and twists
    of the bodies are evaluated from the motions'.

    ``time`` is that at the start [time]; ``load`` a constant wrench on the bodies of which the motions know the force,
    but not the torque about their centres, None without.
    """

    def __init__(self, motions: MotionDynamics, carried: Carried, time: float, load: Wrench | None = None) -> None:
        self._motions, self._carried, self._time, self._load = motions, carried, time, load
        self._impulse = nothing(motions.pose)
        self._place()

    def motions(self, impulse: Wrench) -> MotionState:
        """Motions, and the impulse of contacts on them, summed along the way."""
        return MotionState(self._motions.pose, self._motions.twist, self._impulse, nothing(self._motions.pose))

    @property
    def twist(self) -> Twist:
        return self.kinematics.component_twist(self._motions.twist)

    @property
    def motion_twist(self) -> Twist:
        return self._motions.twist

    def prescribed_part(self, prescribed: BoolArray) -> Twist:
        """Prescribed part of the bodies' twists, n rows, where some motions (N,) are ``prescribed``."""
        twist, given = self._motions.twist, prescribed[:, None]
        return self.kinematics.component_twist(Twist(given * twist.velocity, given * twist.angular_velocity))

    @property
    def friction_loss(self) -> float:
        """Energy dissipated by the motions' drag within substeps [energy]."""
        return self._motions.friction_loss

    @property
    def drag_left_out(self) -> float:
        """Energy by which drag on the motions takes less than the flow dissipates [energy]."""
        return self._motions.drag_left_out

    @property
    def resisted(self) -> bool:
        """Tell whether drag acts on the motions in kicks too."""
        return self._motions.resisted

    @property
    def link_work(self) -> LinkWork:
        """Work of joints on the motions so far."""
        return self._motions.link_work

    def inverse_mass_along(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass e·(G M⁻¹ Gᵀ)e of the motion as its body feels it, (m,) [1/mass]."""
        motion = self.kinematics.carrier[body]
        turning = moment(self.kinematics.arm[body], direction)
        straight = self._motions.inverse_mass_along(motion, direction)
        return np.asarray(straight + np.einsum("mi,mij,mj->m", turning, self._motions.inverse_inertia[motion], turning))

    @property
    def inverse_mass(self) -> FloatArray:
        carrier, lever = self.kinematics.carrier, levers(self.kinematics.arm)
        turning = lever @ self._motions.inverse_inertia[carrier] @ np.swapaxes(lever, -1, -2)
        return np.asarray(self._motions.inverse_mass[carrier] + turning)

    @property
    def inverse_inertia(self) -> FloatArray:
        return self._motions.inverse_inertia[self.kinematics.carrier]

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """Matrix G M⁻¹ Gᵀ, which couples the bodies of one motion."""
        carried = jacobian(self.kinematics)
        return sparse.csr_matrix(carried @ self._motions.inverse_masses(time) @ carried.T)

    def copied(self) -> Self:
        other = copy(self)
        other._motions = self._motions.copied()
        return other

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration of each body (n,): the motion's, |α| |arm| + |ω|² |arm| by its rotation, and the change
        of the relative velocity over the time [length/time²]."""
        now, angular = self.kinematics, self._motions.max_angular_acceleration(time)
        if self._load is not None:
            torque = now.motion_wrench(self._load).torque
            angular = angular + np.linalg.norm(np.einsum("nij,nj->ni", self._motions.inverse_inertia, torque), axis=1)
        spin = np.linalg.norm(self._motions.twist.angular_velocity, axis=1)
        turning = (angular + spin**2)[now.carrier] * np.linalg.norm(now.arm, axis=1)
        later = self._carried.kinematics(self._motions.pose, self._time + time)
        change = np.linalg.norm((later.relative_twist - now.relative_twist)[:, : now.arm.shape[1]], axis=1)
        return np.asarray(self._motions.max_acceleration(time)[now.carrier] + turning + change / time)

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the motions' twists by contacts with this ``wrench`` on the bodies, and by all other forces, for
        ``time``."""
        pushed, so_far = (at or self.kinematics).motion_wrench(wrench), self._impulse
        self._motions.kick(self._turned(pushed), time)
        self._impulse = Wrench(so_far.force + time * pushed.force, so_far.torque + time * pushed.torque)

    def drift(self, time: float) -> None:
        self._motions.drift(time)
        self._time += time
        self._place()

    def _turned(self, wrench: Wrench) -> Wrench:
        """Wrench on the motions, with the torque of the constant load."""
        if self._load is None:
            return wrench
        return Wrench(wrench.force, wrench.torque + self.kinematics.motion_wrench(self._load).torque)

    def _place(self) -> None:
        motions = self._motions.pose
        self.pose: Pose = self._carried.poses(motions, self._time)
        self.kinematics: CarriedKinematics = self._carried.kinematics(motions, self._time)
