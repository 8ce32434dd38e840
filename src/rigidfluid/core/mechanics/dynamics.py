"""How bodies move between contacts, and how they do freely, without a fluid."""

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
    """Sums over what joints did: the ``impulse`` (c,) of each link [force·time | force·length·time], the ``pushed``
    (N, d+k) of all of them and of springs, what they ``driven`` into the motions by all that moves as it is told, and
    ``damped`` away [energy]."""

    impulse: FloatArray
    pushed: FloatArray
    driven: float
    damped: float

    def load(self, time: float) -> LinkLoad:
        """The mean over so long."""
        return LinkLoad(self.impulse / time, self.pushed / time)


class BodyDynamics(Protocol):
    """Bodies in motion; kicked and drifting in turn they follow the velocity Verlet scheme."""

    @property
    def pose(self) -> Pose:
        """Where they are now."""

    @property
    def free(self) -> FreeMotions | None:
        """What carries them, None where each moves by itself."""

    @property
    def kinematics(self) -> Kinematics | None:
        """How motions carry them now, None where each moves by itself."""

    @property
    def twist(self) -> Twist:
        """How they move now."""

    def inverse_mass(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """e·M⁻¹e of some bodies (m,) in directions e (m, d), (m,); zero for bodies that are driven [1/mass]."""

    @property
    def mobility(self) -> FloatArray:
        """M⁻¹ of straight motion of each body by itself (n, d, d), zero for bodies that are driven [1/mass]."""

    @property
    def inverse_inertia(self) -> FloatArray:
        """(R I Rᵀ)⁻¹ (n, k, k), zero for bodies that are driven [1/(mass·length²)]."""

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """M⁻¹ of all velocities (n·(d+k), n·(d+k)), zero for bodies that are driven: times a wrench that lasts for
        ``time``, and the time, it is what that adds to the velocities [1/mass | 1/(mass·length²)]."""

    @property
    def friction_loss(self) -> float:
        """What a fluid's friction took that its own solutions do not see [energy]."""

    @property
    def resisted(self) -> bool:
        """Whether a fluid's friction acts in kicks too: a force then works along the way of drifts alone."""

    @property
    def link_work(self) -> LinkWork | None:
        """What joints did to them so far, None without any."""

    def copied(self) -> Self:
        """The same motion, to be tried out."""

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration of each body in so much time from now by all but contacts, (n,) [length/time²]."""

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the twist as contacts with this ``wrench``, and all else that acts, do in ``time``.

        ``at``: how motions carried the bodies where the wrench is of, if that is not here.
        """

    def drift(self, time: float) -> None:
        """Change the pose as the twist does in ``time``."""


class Turning(NamedTuple):
    """A constant ``torque`` (n, k) on bodies [force·length], whose surfaces reach ``arm`` (n,) far from their centres
    [length]."""

    torque: FloatArray
    arm: FloatArray


class DryDynamics:
    """Newton–Euler without a fluid: m dU/dt = F + W, d(R I Rᵀ ω)/dt = T, between kicks exact.

    Parameters
    ----------
    pose, twist : Pose, Twist
        At the start.
    mass : (n,) array
        Masses [mass].
    inertia : (n, k, k) array
        In each body's frame [mass·length²].
    weight : (n, d) array
        W, what else acts, constant [force].
    controlled : (n,) array
        Where the twist is given.
    controlled_twist : callable
        From a time since the start to the twist (n, d+k) of driven bodies.
    turning : Turning, optional
        Torques besides the weight.
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
        """1/m, whatever the direction."""
        return np.asarray(self._free[body, 0] / self._mass[body])

    @property
    def mobility(self) -> FloatArray:
        return np.asarray((self._free / self._mass[:, None])[:, :, None] * np.eye(self._velocity.shape[1]))

    @property
    def inverse_inertia(self) -> FloatArray:
        return self._inverse_inertia() * self._free[:, :, None]

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """1/m and (R I Rᵀ)⁻¹, whatever the time."""
        return block_diagonal(self.mobility, self.inverse_inertia)

    def copied(self) -> Self:
        """With momenta of its own, which kicks change in place."""
        other = copy(self)
        other._velocity, other._momentum = self._velocity.copy(), self._momentum.copy()
        return other

    def max_acceleration(self, time: float) -> FloatArray:
        """|W|/m, of turned bodies that of their surface, and of driven bodies the greatest change of velocity over the
        time that it is in."""
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
        """None: what turns freely keeps its angular momentum."""
        return np.zeros(len(self._mass))

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change momenta by F + W and T for so long."""
        state = self._velocity, self._momentum
        torque = wrench.torque if self._turning is None else wrench.torque + self._turning.torque
        _kick(*state, wrench.force, torque, self._weight, self._mass, self._free[:, 0], time)

    def begin(self, ahead: float) -> None:
        """Nothing is given of these motions that jumps."""

    def push(self, impulse: FloatArray) -> None:
        """Change momenta by impulses (n, d+k) at once."""
        d = self._velocity.shape[1]
        self._velocity = self._velocity + self._free * impulse[:, :d] / self._mass[:, None]
        self._momentum = self._momentum + self._free * impulse[:, d:]

    def drift(self, time: float) -> None:
        """Move straight on and turn freely; driven bodies with their twist in mid-time."""
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
    """The matrix of all velocities, body by body, of blocks (n, d, d) and (n, k, k)."""
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
    """In place, as fresh arrays of many bodies would cost more than the sums."""
    for body in range(len(velocity)):
        if free[body]:
            share = time / mass[body]
            for k in range(velocity.shape[1]):
                velocity[body, k] += share * (force[body, k] + weight[body, k])
            for k in range(momentum.shape[1]):
                momentum[body, k] += time * torque[body, k]
