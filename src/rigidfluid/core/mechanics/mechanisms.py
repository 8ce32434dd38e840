"""Motions of a system with mechanisms: poses and kinematics of the bodies they carry, and the mass and inertia of
these."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import copy
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.component_dynamics import ComponentDynamics
from rigidfluid.core.mechanics.driven_dynamics import DrivenDynamics
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.kinematics import CarriedKinematics, carried_sum, levers
from rigidfluid.core.mechanics.rigid import angular_momentum, compose, lab_inertia, moment, rotation_matrices, turned
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.dynamics import MotionDynamics
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.state import MotionState
from rigidfluid.core.model.types import Pose, Twist, Wrench


class Relative(NamedTuple):
    """Bodies in the frames of their motions, whose origins are the centres of mass: ``pose`` and its rate ``twist``."""

    pose: Pose
    twist: Twist


class CarriedBodies:
    """Single bodies, each its own motion, and after them the ``mechanisms`` with their components.

    ``mass`` (n,) [mass] and ``inertia`` (n, k, k) in each body's frame [mass·length²] are those of single bodies and of
    all components in order; ``prescribed`` (n,): whether a single body's motion is; ``pose`` and ``twist``:
    the N motions at the start.
    """

    def __init__(
        self,
        mechanisms: Mapping[str, Mechanism],
        mass: FloatArray,
        inertia: FloatArray,
        prescribed: BoolArray,
        pose: Pose,
        twist: Twist,
    ) -> None:
        self.names, self._mechanisms = tuple(mechanisms), tuple(mechanisms.values())
        sizes = [len(mechanism.components) for mechanism in self._mechanisms]
        single = len(mass) - sum(sizes)
        owner = np.repeat(np.arange(single, single + len(sizes)), sizes)
        self.carrier: IntArray = np.concatenate([np.arange(single), owner])
        self.prescribed: BoolArray = np.append(prescribed[:single], np.zeros(len(sizes), dtype=bool))
        self.mass = carried_sum(self.carrier, mass, single + len(sizes))
        self.pose, self.twist = pose, twist
        self.driven_motions: BoolArray = np.array([False] * single + [one.driven for one in self._mechanisms])
        self.driven = bool(self.driven_motions.any())
        self._own_mass, self._own_inertia = mass, inertia
        self._latest: tuple[float, Relative] = 0.0, self._placed(0.0)
        self._arms = np.linalg.norm(self.poses(pose, 0.0).position - pose.position[self.carrier], axis=1)

    def starting_with(self, twist: Twist) -> CarriedBodies:
        """The same bodies with another ``twist`` of the motions at the start."""
        other = copy(self)
        other.twist = twist
        return other

    def poses(self, motions: Pose, time: float) -> Pose:
        """Pose c + R s and R Q of each body."""
        relative, carrier = self._relative(time).pose, self.carrier
        arm = _turned(motions.orientation[carrier], relative.position)
        orientation = compose(motions.orientation[carrier], relative.orientation)
        return Pose(motions.position[carrier] + arm, orientation)

    def kinematics(self, motions: Pose, time: float) -> CarriedKinematics:
        """Arms R s, and the relative velocities R ds/dt and R ν."""
        relative, orientation = self._relative(time), motions.orientation[self.carrier]
        velocity, spin = relative.twist.velocity, relative.twist.angular_velocity
        given = np.concatenate([_turned(orientation, velocity), turned(orientation, spin)], axis=1)
        return CarriedKinematics(self.carrier, motions.position, _turned(orientation, relative.pose.position), given)

    def kinematics_between(self, motions: Pose, bodies: Pose, motion: Twist, body: Twist) -> CarriedKinematics:
        """G and g, read from poses and twists."""
        arm = bodies.position - motions.position[self.carrier]
        rigid = CarriedKinematics(self.carrier, motions.position, arm, np.zeros_like(flat(body)))
        given = flat(body) - flat(rigid.component_twist(motion))
        return CarriedKinematics(self.carrier, motions.position, arm, given)

    def inertia(self, time: float) -> FloatArray:
        """Inertia Σ Q I Qᵀ + m (|s|² - s sᵀ) of all that each motion carries, (N, k, k) [mass·length²]."""
        pose = self._relative(time).pose
        own = lab_inertia(self._own_inertia, pose.orientation)
        return self.sums(own + self._own_mass[:, None, None] * _unit_inertia(pose.position))

    def inverse_masses(self, mass: FloatArray, bodies: Pose, centre: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inverse of Σ m and of Σ R I Rᵀ + Xᵀ m X, with the lever matrices X of the bodies' arms."""
        lever = levers(bodies.position - centre[self.carrier])
        turning = lab_inertia(self._own_inertia, bodies.orientation) + np.swapaxes(lever, -1, -2) @ mass @ lever
        return np.asarray(np.linalg.inv(self.sums(mass))), np.asarray(np.linalg.inv(self.sums(turning)))

    def spin(self, time: float) -> FloatArray:
        """Relative angular momentum Σ Q I Qᵀ ν + m s × ds/dt of all that each motion carries, (N, k)
        [mass·length²/time]."""
        pose, twist = self._relative(time)
        own = angular_momentum(self._own_inertia, pose.orientation, twist.angular_velocity)
        return self.sums(own + self._own_mass[:, None] * moment(pose.position, twist.velocity))

    def next_corner(self, time: float) -> float:
        """First time after this at which the rate of a mechanism jumps [time]."""
        return min(mechanism.next_corner(time) for mechanism in self._mechanisms)

    def sums(self, rows: FloatArray) -> FloatArray:
        return carried_sum(self.carrier, rows, len(self.mass))

    def least(self, values: FloatArray) -> FloatArray:
        least = np.full(len(self.mass), np.inf)
        np.minimum.at(least, self.carrier, values)
        return least

    def reaches(self, radii: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Largest radius, and greatest sum of arm and radius at the start."""
        largest, farthest = np.zeros((2, len(self.mass)))
        np.maximum.at(largest, self.carrier, radii)
        np.maximum.at(farthest, self.carrier, self._arms + radii)
        return largest, farthest

    def dry_dynamics(
        self,
        now: MotionState,
        load: Wrench,
        arms: FloatArray,
        start: float,
        prescribed_twist: Callable[[float], FloatArray],
    ) -> DryDynamics:
        """Dynamics that know the force of the load; its torque about the centres is `carry`'s."""
        force = self.sums(load.force)
        if self.driven:
            return DrivenDynamics(now.pose, now.twist, self, force, start, prescribed_twist)
        own = self.mass, self.inertia(start), force, self.prescribed
        return DryDynamics(now.pose, now.twist, *own, prescribed_twist)

    def carry(self, motions: MotionDynamics, start: float, load: Wrench | None = None) -> ComponentDynamics:
        return ComponentDynamics(motions, self, start, load)

    def _relative(self, time: float) -> Relative:
        """Relative poses and rates at a ``time``; the latest are kept, since one time is asked for repeatedly."""
        if self.driven and time != self._latest[0]:
            self._latest = time, self._placed(time)
        return self._latest[1]

    def _placed(self, time: float) -> Relative:
        """Relative poses and rates of all bodies; single ones rest in their own frames."""
        dimension, k = self.pose.position.shape[1], self._own_inertia.shape[1]
        count, single = len(self.carrier), len(self.mass) - len(self._mechanisms)
        position, velocity, spin = np.zeros((count, dimension)), np.zeros((count, dimension)), np.zeros((count, k))
        orientation = np.tile(np.eye(1, 4) if dimension == 3 else np.zeros((1, 1)), (count, 1))
        for number, mechanism in enumerate(self._mechanisms, start=single):
            mine = self.carrier == number
            pose, rate = mechanism.placement(time), mechanism.rate(time)
            share = self._own_mass[mine] / self.mass[number]
            position[mine] = pose.position - share @ pose.position
            velocity[mine] = rate.velocity - share @ rate.velocity
            orientation[mine], spin[mine] = pose.orientation, rate.angular_velocity
        return Relative(Pose(position, orientation), Twist(velocity, spin))


def _turned(orientation: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (n, d) of the motions' frames in the lab frame, R v."""
    return np.asarray(np.einsum("nij,nj->ni", rotation_matrices(orientation), vectors))


def _unit_inertia(arm: FloatArray) -> FloatArray:
    """Inertia over mass |r|² - r rᵀ of points, (n, k, k), |r|² in 2D [length²]."""
    square = np.sum(arm**2, axis=1)[:, None, None]
    if arm.shape[1] == 2:
        return np.asarray(square)
    return np.asarray(square * np.eye(3) - arm[:, :, None] * arm[:, None, :])
