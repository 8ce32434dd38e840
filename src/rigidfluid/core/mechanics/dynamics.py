"""Dynamics of bodies without a fluid, between contacts."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import lru_cache
from typing import Any, NamedTuple, Self

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.matrices import assembled
from rigidfluid.core.mechanics.own_motions import OwnMotions
from rigidfluid.core.mechanics.rigid import angular_momentum, inverse_lab_inertia, is_isotropic
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.types import Pose, Twist, Wrench

_PARTS = np.linspace(0.0, 1.0, 17)[1:]


class Turning(NamedTuple):
    """Constant ``torque`` (n, k) on bodies [force·length], and the distance ``arm`` (n,) of their farthest surface
    points from their centres [length]."""

    torque: FloatArray
    arm: FloatArray


class FreeBalls(NamedTuple):
    """Arrays of balls that move freely: ``position`` (n, d), ``orientation`` (n, q), ``velocity`` (n, d), angular
    ``momentum`` (n, k), ``mass`` and ``inverse_inertia`` (n,) of each, and ``weight`` (n, d)."""

    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    momentum: FloatArray
    mass: FloatArray
    inverse_inertia: FloatArray
    weight: FloatArray


class DryDynamics(OwnMotions):
    """Newton–Euler without a fluid: m dU/dt = F + W, d(R I Rᵀ ω)/dt = T, between kicks exact.

    ``mass`` (n,) [mass]; ``inertia`` (n, k, k) in each body's frame [mass·length²]; ``weight`` W (n, d), all constant
    forces [force]; ``prescribed`` (n,), whether the twist is, by ``prescribed_twist`` from a time since the
    start to (n, d+k); ``turning``: constant torques, None without.
    """

    friction_loss: float = 0.0
    drag_left_out: float = 0.0
    resisted: bool = False

    def __init__(
        self,
        pose: Pose,
        twist: Twist,
        mass: FloatArray,
        inertia: FloatArray,
        weight: FloatArray,
        prescribed: BoolArray,
        prescribed_twist: Callable[[float], FloatArray],
        turning: Turning | None = None,
    ) -> None:
        self.pose, self._turning = pose, turning
        self._free = ~prescribed[:, None]
        self._mass, self._inertia, self._weight = mass, inertia, weight
        self._prescribed_twist, self._time = prescribed_twist, 0.0
        self._inverse_mass = np.asarray((self._free / mass[:, None])[:, :, None] * np.eye(pose.position.shape[1]))
        self._any_prescribed = bool(prescribed.any())
        self._velocity = twist.velocity.copy()
        self._round = is_isotropic(inertia)
        unit = np.eye(inertia.shape[1])
        self._inverse: FloatArray = np.asarray(unit / inertia[:, :1, :1] if self._round else np.linalg.inv(inertia))
        self._balls = self._inverse[:, 0, 0].copy() if self._round and inertia.shape[1] == 3 else None
        self._momentum = angular_momentum(inertia, pose.orientation, twist.angular_velocity)

    @property
    def twist(self) -> Twist:
        if self._round:  # the same numbers as by the matrices
            return Twist(self._velocity.copy(), self._inverse[:, 0, :1] * self._momentum)
        return Twist(self._velocity.copy(), np.einsum("nij,nj->ni", self._inverse_inertia(), self._momentum))

    def inverse_mass_along(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass 1/m, whatever the direction."""
        return np.asarray(self._free[body, 0] / self._mass[body])

    @property
    def inverse_mass(self) -> FloatArray:
        return self._inverse_mass

    @property
    def inverse_inertia(self) -> FloatArray:
        return self._inverse_inertia() * self._free[:, :, None]

    def inverse_masses(self, time: float) -> Any:
        """Matrix of 1/m and (R I Rᵀ)⁻¹, whatever the time."""
        return block_diagonal(self.inverse_mass, self.inverse_inertia)

    def copied(self) -> Self:
        """Copy with momenta of its own, which kicks change in place."""
        other = copy(self)
        other._velocity, other._momentum = self._velocity.copy(), self._momentum.copy()
        return other

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration (n,): |W|/m, with a constant torque that of the farthest surface point, and of
        prescribed bodies the greatest change of velocity within the time, over the time [length/time²]."""
        fall = np.linalg.norm(self._weight, axis=1) / self._mass
        if self._turning is not None:
            lightest = np.linalg.eigvalsh(self._inverse)[:, -1]
            fall = fall + self._turning.arm * lightest * np.linalg.norm(self._turning.torque, axis=1)
        if not self._any_prescribed:
            return np.asarray(fall)
        now, d = self._prescribed_twist(self._time), self._velocity.shape[1]
        later = [self._prescribed_twist(self._time + part * time) for part in _PARTS]
        change = np.max([np.linalg.norm((given - now)[:, :d], axis=1) for given in later], axis=0)
        return np.asarray(np.where(self._free[:, 0], fall, change / time))

    def max_angular_acceleration(self, time: float) -> FloatArray:
        """Zero (n,): a body that turns freely keeps its angular momentum."""
        return np.zeros(len(self._mass))

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change momenta by F + W and T for ``time``."""
        from rigidfluid.core.mechanics.momenta import add_kick

        state = self._velocity, self._momentum
        torque = wrench.torque if self._turning is None else wrench.torque + self._turning.torque
        add_kick(*state, wrench.force, torque, self._weight, self._mass, self._free[:, 0], time)

    def begin(self, ahead: float) -> None:
        """No-op: these motions have no prescribed velocity jump."""

    def apply_impulse(self, impulse: FloatArray) -> None:
        """Change momenta by impulses (n, d+k) at once."""
        d = self._velocity.shape[1]
        self._velocity = self._velocity + self._free * impulse[:, :d] / self._mass[:, None]
        self._momentum = self._momentum + self._free * impulse[:, d:]

    def drift(self, time: float) -> None:
        """Move straight on and turn freely; move prescribed bodies with their twist in mid-time."""
        from rigidfluid.core.mechanics.free_rotation import rotate_freely, turn_balls

        if self._any_prescribed:
            self._prescribe(self._time + 0.5 * time)
        orientation = self.pose.orientation
        if self._balls is not None:
            orientation = turn_balls(orientation, self._momentum, self._balls, time)
        else:
            orientation = rotate_freely(orientation, self._momentum, self._inertia, time)
        self.pose = Pose(self.pose.position + time * self._velocity, orientation)
        self._time += time
        if self._any_prescribed:
            self._prescribe(self._time)

    @property
    def is_of_free_balls(self) -> bool:
        """Tell whether the inertia of each body is that of a ball, and none is prescribed or under a torque."""
        return type(self) is DryDynamics and self._round and not self._any_prescribed and self._turning is None

    def free_balls(self) -> FreeBalls:
        """The present state as balls that move freely: velocities and momenta are those of the bodies themselves."""
        pose, ordered = self.pose, np.ascontiguousarray
        place = np.array(pose.position, order="C"), np.array(pose.orientation, order="C")
        own = ordered(self._mass), ordered(self._inverse[:, 0, 0]), ordered(self._weight)
        return FreeBalls(*place, self._velocity, self._momentum, *own)

    def place(self, balls: FreeBalls, time: float) -> None:
        """Take over the pose of ``balls`` that have moved for a ``time``."""
        self.pose = Pose(balls.position, balls.orientation)
        self._time += time

    def _prescribe(self, time: float) -> None:
        given, d = self._prescribed_twist(time), self._velocity.shape[1]
        self._velocity = np.where(self._free, self._velocity, given[:, :d])
        spin = angular_momentum(self._inertia, self.pose.orientation, given[:, d:])
        self._momentum = np.where(self._free, self._momentum, spin)

    def _inverse_inertia(self) -> FloatArray:
        if self._round:
            return self._inverse
        return inverse_lab_inertia(self._inertia, self.pose.orientation)


def block_diagonal(linear: FloatArray, angular: FloatArray) -> Any:
    """Matrix of all velocities, body by body, with blocks (n, d, d) and (n, k, k); sparse for many bodies."""
    count, d, k = len(linear), linear.shape[1], angular.shape[1]
    entries = np.concatenate([linear.ravel(), angular.ravel()])
    return assembled(entries, *_places(count, d, k), (count * (d + k),) * 2)


@lru_cache(maxsize=4)
def _places(count: int, d: int, k: int) -> tuple[IntArray, IntArray]:
    """Rows and columns of the entries of all blocks (n, d, d) and then (n, k, k)."""
    rows, columns = [], []
    for first, size in ((0, d), (d, k)):
        start = (d + k) * np.arange(count)[:, None, None] + first
        rows.append((start + np.arange(size)[:, None] + np.zeros(size, dtype=int)).ravel())
        columns.append((start + np.zeros(size, dtype=int)[:, None] + np.arange(size)).ravel())
    return np.concatenate(rows), np.concatenate(columns)
