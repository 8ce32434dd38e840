"""Bodies that motions carry, as contacts see them."""

from __future__ import annotations

from copy import copy
from typing import Protocol, Self

import numpy as np
from scipy import sparse

from rigidfluid.core.mechanics.dynamics import BodyDynamics, LinkWork
from rigidfluid.core.mechanics.kinematics import component_twist, free_wrench, jacobian, levers
from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.state import FreeMotions
from rigidfluid.core.model.system import Mechanisms
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Kinematics, Pose, Twist, Wrench


class MotionDynamics(BodyDynamics, Protocol):
    """Motions on their own way."""

    def angular_pull(self, time: float) -> FloatArray:
        """Greatest angular acceleration of each in so much time from now by all but contacts, (N,) [rad/time²]."""


class ComponentDynamics:
    """Kicks reach the motions as Gᵀ of them; poses and twists of the bodies are evaluated from the motions'.

    Parameters
    ----------
    motions : MotionDynamics
        The N motions; changed in place.
    mechanisms : Mechanisms
        How they carry the n bodies.
    time : float
        At the start [time].
    load : Wrench, optional
        Constant, on the bodies, where the motions know its force alone, and not that it turns them.
    """

    def __init__(
        self, motions: MotionDynamics, mechanisms: Mechanisms, time: float, load: Wrench | None = None
    ) -> None:
        self._motions, self._mechanisms, self._time, self._load = motions, mechanisms, time, load
        self._impulse = nothing(motions.pose)
        self._place()

    @property
    def free(self) -> FreeMotions:
        """The motions, and what contacts gave to them."""
        return FreeMotions(self._motions.pose, self._motions.twist, self._impulse, nothing(self._motions.pose))

    @property
    def twist(self) -> Twist:
        return component_twist(self.kinematics, self._motions.twist)

    def given_twist(self, controlled: BoolArray) -> Twist:
        """That part of the twists that no free motion has a share in, where some (N,) are ``controlled``."""
        twist, given = self._motions.twist, controlled[:, None]
        return component_twist(self.kinematics, Twist(given * twist.velocity, given * twist.angular_velocity))

    @property
    def friction_loss(self) -> float:
        """Of the motions [energy]."""
        return self._motions.friction_loss

    @property
    def resisted(self) -> bool:
        """As the motions are."""
        return self._motions.resisted

    @property
    def link_work(self) -> LinkWork | None:
        """Of the motions."""
        return self._motions.link_work

    def inverse_mass(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """e·(G M⁻¹ Gᵀ)e: of the motion as its body feels it."""
        motion = self.kinematics.carrier[body]
        turning = moment(self.kinematics.arm[body], direction)
        straight = self._motions.inverse_mass(motion, direction)
        return np.asarray(straight + np.einsum("mi,mij,mj->m", turning, self._motions.inverse_inertia[motion], turning))

    @property
    def mobility(self) -> FloatArray:
        carrier, lever = self.kinematics.carrier, levers(self.kinematics.arm)
        turning = lever @ self._motions.inverse_inertia[carrier] @ np.swapaxes(lever, -1, -2)
        return np.asarray(self._motions.mobility[carrier] + turning)

    @property
    def inverse_inertia(self) -> FloatArray:
        return self._motions.inverse_inertia[self.kinematics.carrier]

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """G M⁻¹ Gᵀ, bodies of one motion coupled."""
        carried = jacobian(self.kinematics)
        return sparse.csr_matrix(carried @ self._motions.inverse_masses(time) @ carried.T)

    def copied(self) -> Self:
        other = copy(self)
        other._motions = self._motions.copied()
        return other

    def max_acceleration(self, time: float) -> FloatArray:
        """Of the motion, and by its rotation: |α| |arm| + |ω|² |arm|; and what changes in the relative motion."""
        now, pull = self.kinematics, self._motions.angular_pull(time)
        if self._load is not None:
            torque = free_wrench(now, self._load).torque
            pull = pull + np.linalg.norm(np.einsum("nij,nj->ni", self._motions.inverse_inertia, torque), axis=1)
        spin = np.linalg.norm(self._motions.twist.angular_velocity, axis=1)
        turning = (pull + spin**2)[now.carrier] * np.linalg.norm(now.arm, axis=1)
        later = self._mechanisms.kinematics(self._motions.pose, self._time + time)
        change = np.linalg.norm((later.given - now.given)[:, : now.arm.shape[1]], axis=1)
        return np.asarray(self._motions.max_acceleration(time)[now.carrier] + turning + change / time)

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the motions' twists as contacts with this ``wrench`` on the bodies, and all else that acts, do."""
        pushed, so_far = free_wrench(at or self.kinematics, wrench), self._impulse
        self._motions.kick(self._turned(pushed), time)
        self._impulse = Wrench(so_far.force + time * pushed.force, so_far.torque + time * pushed.torque)

    def drift(self, time: float) -> None:
        self._motions.drift(time)
        self._time += time
        self._place()

    def _turned(self, wrench: Wrench) -> Wrench:
        """The wrench on the motions, with the torque of the constant load."""
        if self._load is None:
            return wrench
        return Wrench(wrench.force, wrench.torque + free_wrench(self.kinematics, self._load).torque)

    def _place(self) -> None:
        motions = self._motions.pose
        self.pose: Pose = self._mechanisms.poses(motions, self._time)
        self.kinematics: Kinematics = self._mechanisms.kinematics(motions, self._time)
