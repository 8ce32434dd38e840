"""Dynamics of bodies between contacts, and without a fluid in particular."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import NamedTuple, Protocol, Self

import numpy as np
from numba import njit
from scipy import sparse

from rigidfluid.core.mechanics.free_rotation import rotate_freely
from rigidfluid.core.mechanics.rigid import inverse_lab_inertia, lab_inertia
from rigidfluid.core.model.state import FreeMotions, LinkLoad
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Kinematics, Pose, Twist, Wrench

_PARTS = np.linspace(0.0, 1.0, 17)[1:]


@dataclass(frozen=True, slots=True)
class LinkWork:
    """Sums over the work of joints: the ``impulse`` (c,) of each link [force·time | force·length·time], the ``pushed``
    (N, d+k) impulse of all links and springs on the motions, the energies ``driven`` into the motions by prescribed
    ones and ``damped`` away [energy]."""

    impulse: FloatArray
    pushed: FloatArray
    driven: float
    damped: float

    def load(self, time: float) -> LinkLoad:
        """Mean loads over ``time``."""
        return LinkLoad(self.impulse / time, self.pushed / time)


class BodyDynamics(Protocol):
    """Dynamics of n bodies; kicked and drifting in turn they follow the velocity Verlet scheme."""

    @property
    def pose(self) -> Pose:
        """Present pose."""

    @property
    def free(self) -> FreeMotions | None:
        """Motions that carry the bodies, None where each moves by itself."""

    @property
    def kinematics(self) -> Kinematics | None:
        """Present G and g of the motions that carry the bodies, None where each moves by itself."""

    @property
    def twist(self) -> Twist:
        """Present twist."""

    def inverse_mass(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass e·M⁻¹e of some bodies (m,) in directions e (m, d), (m,); zero for prescribed bodies [1/mass]."""

    @property
    def mobility(self) -> FloatArray:
        """Inverse mass M⁻¹ of each body alone in translation (n, d, d), zero for prescribed bodies [1/mass]."""

    @property
    def inverse_inertia(self) -> FloatArray:
        """Inverse inertia (R I Rᵀ)⁻¹ (n, k, k), zero for prescribed bodies [1/(mass·length²)]."""

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """Matrix M⁻¹ of all velocities (n·(d+k), n·(d+k)), zero for prescribed bodies: M⁻¹ W ``time`` is the change of
        the velocities by a wrench W that lasts for ``time`` [1/mass | 1/(mass·length²)]."""

    @property
    def friction_loss(self) -> float:
        """Energy dissipated by drag within substeps, unresolved by the fluid solves [energy]."""

    @property
    def resisted(self) -> bool:
        """Whether drag acts in kicks too: the work of a force is then its product with the displacement in drifts
        alone."""

    @property
    def link_work(self) -> LinkWork | None:
        """Work of joints so far, None without any."""

    def copied(self) -> Self:
        """Copy of the motion, for a trial."""

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration of each body (n,) within ``time`` from now, contacts apart [length/time²]."""

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the twist by contacts with this ``wrench``, and by all other forces, for ``time``.

        ``at``: kinematics at the pose that the wrench belongs to, None for the present one.
        """

    def drift(self, time: float) -> None:
        """Change the pose with the present twist for ``time``."""


class Turning(NamedTuple):
    """Constant ``torque`` (n, k) on bodies [force·length], and the distance ``arm`` (n,) of their farthest surface
    points from their centres [length]."""

    torque: FloatArray
    arm: FloatArray


class DryDynamics:
    """Newton–Euler without a fluid: m dU/dt = F + W, d(R I Rᵀ ω)/dt = T, between kicks exact.

    ``mass`` (n,) [mass]; ``inertia`` (n, k, k) in each body's frame [mass·length²]; ``weight`` W (n, d), all constant
    forces [force]; ``controlled`` (n,), whether the twist is prescribed, by ``controlled_twist`` from a time since the
    start to (n, d+k); ``turning``: constant torques, None without.
    """

    free: FreeMotions | None = None
    kinematics: Kinematics | None = None
    friction_loss: float = 0.0
    resisted: bool = False
    link_work: LinkWork | None = None

    def __init__(
        self,
        pose: Pose,
        twist: Twist,
        mass: FloatArray,
        inertia: FloatArray,
        weight: FloatArray,
        controlled: BoolArray,
        controlled_twist: Callable[[float], FloatArray],
        turning: Turning | None = None,
    ) -> None:
        self.pose, self._turning = pose, turning
        self._free = ~controlled[:, None]
        self._mass, self._inertia, self._weight = mass, inertia, weight
        self._given, self._time = controlled_twist, 0.0
        self._driven = bool(controlled.any())
        self._velocity = twist.velocity.copy()
        self._inverse: FloatArray = np.asarray(np.linalg.inv(inertia), dtype=np.float64)
        self._round = bool(np.all(inertia == inertia[:, :1, :1] * np.eye(inertia.shape[1])))
        spin = lab_inertia(inertia, pose.orientation)
        self._momentum = np.einsum("nij,nj->ni", spin, twist.angular_velocity)

    @property
    def twist(self) -> Twist:
        return Twist(self._velocity.copy(), np.einsum("nij,nj->ni", self._inverse_inertia(), self._momentum))

    def inverse_mass(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass 1/m, whatever the direction."""
        return np.asarray(self._free[body, 0] / self._mass[body])

    @property
    def mobility(self) -> FloatArray:
        return np.asarray((self._free / self._mass[:, None])[:, :, None] * np.eye(self._velocity.shape[1]))

    @property
    def inverse_inertia(self) -> FloatArray:
        return self._inverse_inertia() * self._free[:, :, None]

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """Matrix of 1/m and (R I Rᵀ)⁻¹, whatever the time."""
        return block_diagonal(self.mobility, self.inverse_inertia)

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
        if not self._driven:
            return np.asarray(fall)
        now, d = self._given(self._time), self._velocity.shape[1]
        later = [self._given(self._time + part * time) for part in _PARTS]
        change = np.max([np.linalg.norm((given - now)[:, :d], axis=1) for given in later], axis=0)
        return np.asarray(np.where(self._free[:, 0], fall, change / time))

    def angular_pull(self, time: float) -> FloatArray:
        """Zero (n,): a body that turns freely keeps its angular momentum."""
        return np.zeros(len(self._mass))

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change momenta by F + W and T for ``time``."""
        state = self._velocity, self._momentum
        torque = wrench.torque if self._turning is None else wrench.torque + self._turning.torque
        _kick(*state, wrench.force, torque, self._weight, self._mass, self._free[:, 0], time)

    def begin(self, ahead: float) -> None:
        """No-op: these motions have no prescribed velocity jump."""

    def push(self, impulse: FloatArray) -> None:
        """Change momenta by impulses (n, d+k) at once."""
        d = self._velocity.shape[1]
        self._velocity = self._velocity + self._free * impulse[:, :d] / self._mass[:, None]
        self._momentum = self._momentum + self._free * impulse[:, d:]

    def drift(self, time: float) -> None:
        """Move straight on and turn freely; move prescribed bodies with their twist in mid-time."""
        if self._driven:
            self._drive(self._time + 0.5 * time)
        orientation = rotate_freely(self.pose.orientation, self._momentum, self._inertia, time)
        self.pose = Pose(self.pose.position + time * self._velocity, orientation)
        self._time += time
        if self._driven:
            self._drive(self._time)

    def _drive(self, time: float) -> None:
        given, d = self._given(time), self._velocity.shape[1]
        self._velocity = np.where(self._free, self._velocity, given[:, :d])
        spin = np.einsum("nij,nj->ni", lab_inertia(self._inertia, self.pose.orientation), given[:, d:])
        self._momentum = np.where(self._free, self._momentum, spin)

    def _inverse_inertia(self) -> FloatArray:
        if self._round:
            return self._inverse
        return inverse_lab_inertia(self._inertia, self.pose.orientation)


def block_diagonal(linear: FloatArray, angular: FloatArray) -> sparse.csr_matrix:
    """Matrix of all velocities, body by body, with blocks (n, d, d) and (n, k, k)."""
    count, d, k = len(linear), linear.shape[1], angular.shape[1]
    rows, columns, values = [], [], []
    for first, block in ((0, linear), (d, angular)):
        size = block.shape[1]
        start = (d + k) * np.arange(count)[:, None, None] + first
        rows.append((start + np.arange(size)[:, None] + np.zeros(size, dtype=int)).ravel())
        columns.append((start + np.zeros(size, dtype=int)[:, None] + np.arange(size)).ravel())
        values.append(block.ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    return sparse.csr_matrix((np.concatenate(values), places), shape=(count * (d + k),) * 2)


@njit(cache=True)
def _kick(velocity, momentum, force, torque, weight, mass, free, time):  # type: ignore[no-untyped-def]
    """Kick in place, as fresh arrays of many bodies would cost more than the sums."""
    for body in range(len(velocity)):
        if free[body]:
            share = time / mass[body]
            for k in range(velocity.shape[1]):
                velocity[body, k] += share * (force[body, k] + weight[body, k])
            for k in range(momentum.shape[1]):
                momentum[body, k] += time * torque[body, k]
