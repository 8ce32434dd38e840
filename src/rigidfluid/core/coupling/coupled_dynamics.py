"""Dynamics of bodies in a fluid between two fluid solves."""

from __future__ import annotations

from copy import copy
from typing import NamedTuple, Self

import numpy as np
from scipy import sparse

from rigidfluid.core.contact.path.modal_substeps import ModalBalls, Modes
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.dynamics import block_diagonal
from rigidfluid.core.mechanics.own_motions import OwnMotions
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.types import Pose, Twist, Wrench


class CoupledDynamics(OwnMotions):
    """Dynamics dU/dt = A + M⁻¹F, and of the velocities in a `ReducedModel` dU/dt = M⁻¹ (Φ + F - R (U - Uⁿ)), in modes
    exactly.

    ``rate`` A (n, d+k) is the acceleration without contacts, not read for velocities in the model [length/time² |
    rad/time²]; ``linear`` (n, d, d) and ``angular`` (n, k, k) are M⁻¹ of bodies outside the model in the lab frame,
    zero for prescribed ones [1/mass | 1/(mass·length²)]; ``coupling`` has the model and Φ, which is constant unless
    `vary_load` is called; ``weight`` (c,) is that of the model's velocities in a fluid without inertia, else None
    [force | force·length]: all else of Φ - R (U - Uⁿ) is then its friction, known at all times.
    """

    resisted: bool = True

    def __init__(
        self,
        pose: Pose,
        twist: Twist,
        rate: FloatArray,
        linear: FloatArray,
        angular: FloatArray,
        coupling: Coupling,
        weight: FloatArray | None = None,
    ) -> None:
        model, load = coupling.model, coupling.load
        self.pose = pose
        self._start = flat(twist)
        self._velocity = self._start
        self._model = model
        self._own = linear, angular
        self._rate = rate.copy()
        self._rate.flat[model.velocities] = model.modes @ (model.modes.T @ load)
        self._load, self._growth, self._time = model.modes.T @ load, np.zeros(len(load)), 0.0
        self._lacking = np.where(np.isnan(coupling.load_before), 0.0, load - coupling.load_before)
        self._modal = np.zeros(len(load))
        self._weight = None if weight is None else model.modes.T @ weight
        self.inverse_mass, self.inverse_inertia = self._blocks()
        self._friction = _Friction(np.zeros((3, len(load))))
        self._decayed = _Decayed.after(0.0, model.decay)

    def vary_load(self, time: float, varying: BoolArray) -> None:
        """Let the components of Φ that are ``varying`` (N, d+k) grow linearly from now on, from their values before to
        those after ``time``."""
        change = self._model.modes.T @ np.where(varying.ravel()[self._model.velocities], self._lacking, 0.0)
        self._load, self._growth = self._load - change, change / time

    @property
    def twist(self) -> Twist:
        d = self.pose.position.shape[1]
        return Twist(self._velocity[:, :d], self._velocity[:, d:])

    def copied(self) -> Self:
        """Copy that shares poses and velocities, which are never changed in place, but not the sums of friction."""
        other = copy(self)
        other._friction = copy(self._friction)
        return other

    def inverse_mass_along(self, body: IntArray, direction: FloatArray) -> FloatArray:
        """Inverse mass of the body alone, others held by nothing but the fluid."""
        return np.asarray(np.einsum("mi,mij,mj->m", direction, self.inverse_mass[body], direction))

    def inverse_masses(self, time: float) -> sparse.csr_matrix:
        """Matrix M⁻¹ of all velocities, in the model X φ₁(λ time) Xᵀ: the mean response to a force that lasts for
        ``time``."""
        width = self._velocity.shape[1]
        outside = np.ones(self._velocity.size)
        outside[self._model.velocities] = 0.0
        own = sparse.diags(outside) @ sparse.csr_matrix(block_diagonal(*self._own)) @ sparse.diags(outside)
        modes = self._model.modes
        dense = (modes * _phi(self._model.decay * time)) @ modes.T
        place = self._model.velocities
        rows, columns = np.repeat(place, len(place)), np.tile(place, len(place))
        inside = sparse.csr_matrix((dense.ravel(), (rows, columns)), shape=(width * len(self._velocity),) * 2)
        return sparse.csr_matrix(own + inside)

    def max_acceleration(self, time: float) -> FloatArray:
        """Greatest acceleration |A|, or |M⁻¹Φ| (n,); without inertia of the fluid the mean over the time, as friction
        ends it soon [length/time²]."""
        return np.asarray(np.linalg.norm(self._greatest_rates(time)[:, : self.pose.position.shape[1]], axis=1))

    def max_angular_acceleration(self, time: float) -> FloatArray:
        """Greatest angular acceleration (n,), as in `max_acceleration` [rad/time²]."""
        return np.asarray(np.linalg.norm(self._greatest_rates(time)[:, self.pose.position.shape[1] :], axis=1))

    def _greatest_rates(self, time: float) -> FloatArray:
        if self._weight is None:
            return self._rate
        rate, modes = self._rate.copy(), np.abs(self._model.modes)
        now = self._load + self._time * self._growth - self._model.decay * self._modal
        greatest = np.maximum(np.abs(now), np.abs(now + time * self._growth))
        rate.flat[self._model.velocities] = modes @ (_phi(self._model.decay * time) * greatest)
        return rate

    def kick(self, wrench: Wrench, time: float, at: Kinematics | None = None) -> None:
        """Change the velocities by the wrench and all other forces for ``time``."""
        d, model = wrench.force.shape[1], self._model
        load, self._time = self._load + self._time * self._growth, self._time + time
        velocity = self._velocity + time * self._rate
        velocity[:, :d] += time * np.einsum("nij,nj->ni", self._own[0], wrench.force)
        velocity[:, d:] += time * np.einsum("nij,nj->ni", self._own[1], wrench.torque)
        force = load + model.modes.T @ flat(wrench).flat[model.velocities]
        self._decay_for(time)
        share, gained, growing = self._decayed.share, self._decayed.gained, self._decayed.growing
        self._modal = share * self._modal + gained * force + growing * self._growth
        velocity.flat[model.velocities] = self._start.flat[model.velocities] + model.modes @ self._modal
        self._velocity = velocity

    def _decay_for(self, time: float) -> None:
        """Evaluate the factors of kicks as long as ``time``, unless the latest were as long."""
        if self._decayed.time != time:
            self._decayed = _Decayed.after(time, self._model.decay)

    @property
    def turns(self) -> bool:
        """Tell whether the model has angular velocities."""
        axis = self._model.velocities % self._velocity.shape[1]
        return bool(np.any(axis >= self.pose.position.shape[1]))

    def modal_balls(self, kick: float) -> tuple[ModalBalls, Modes]:
        """Copies of the present state of all bodies, as balls, and of the modes, with the factors of a ``kick``
        [time]."""
        d, model = self.pose.position.shape[1], self._model
        place = np.array(self.pose.position, order="C"), np.array(self.pose.orientation, order="C")
        twist, rate = ((each[:, :d].copy(), each[:, d:].copy()) for each in (self._velocity, self._rate))
        balls = ModalBalls(*place, *twist, *rate, np.ascontiguousarray(self._own[0]))
        body, axis = np.divmod(model.velocities, self._velocity.shape[1])
        start, shape = self._start.flat[model.velocities], np.ascontiguousarray(model.modes)
        own = self._modal.copy(), self._load, self._growth
        self._decay_for(kick)
        factors = self._decayed.share, self._decayed.gained, self._decayed.growing
        return balls, Modes(body, axis, shape, start, *own, *factors, *self._friction.with_time(self._time))

    def place_balls(self, balls: ModalBalls, modes: Modes) -> None:
        """Take over ``balls`` and ``modes`` that have moved."""
        self.pose = Pose(balls.position, balls.orientation)
        self._velocity = np.concatenate([balls.velocity, balls.spin], axis=1)
        self._modal, self._time = modes.modal, float(modes.times[0])
        self._friction = _Friction(modes.integrals, float(modes.times[1]))

    def begin(self, ahead: float) -> None:
        """No-op: these motions have no prescribed velocity jump."""

    def apply_impulse(self, impulse: FloatArray) -> None:
        """Change the velocities by impulses (n, d+k) at once, by the masses alone."""
        d, model = self.pose.position.shape[1], self._model
        velocity = self._velocity.copy()
        velocity[:, :d] += np.einsum("nij,nj->ni", self._own[0], impulse[:, :d])
        velocity[:, d:] += np.einsum("nij,nj->ni", self._own[1], impulse[:, d:])
        self._modal = self._modal + model.modes.T @ impulse.flat[model.velocities]
        velocity.flat[model.velocities] = self._start.flat[model.velocities] + model.modes @ self._modal
        self._velocity = velocity

    def drift(self, time: float) -> None:
        """Move and turn with the present twist."""
        d = self.pose.position.shape[1]
        position = self.pose.position + time * self._velocity[:, :d]
        self.pose = Pose(position, rotate(self.pose.orientation, time * self._velocity[:, d:]))
        self._friction.add(self._modal, time)

    @property
    def friction_loss(self) -> float:
        """Energy dissipated by drag within substeps, ∫ (U - U_lin)ᵀ R (U - U_lin) dt with U_lin linear from start to
        end [energy].

        The loss without inertia of the fluid is all that of the path's friction, less Simpson's rule for it by the
        fluid solves: at both ends, and in the middle by the mean force at the mean velocity.
        """
        if self._weight is None:
            return self._friction.beyond_linear(self._modal, self._model.decay)
        start = self._model.modes.T @ self._model.mass_times(self._start.flat[self._model.velocities])
        resisting = self._weight - self._load, -self._growth
        return self._friction.beyond_simpson(self._modal, self._model.decay, start, resisting)

    @property
    def drag_left_out(self) -> float:
        """Energy Δt/6 ΔUᵀ R ΔU of the velocities' change ΔU since the start, none without inertia of the fluid, which
        has no memory there [energy]."""
        return self._friction.left_out(self._modal, self._model.decay) if self._weight is None else 0.0

    def _blocks(self) -> tuple[FloatArray, FloatArray]:
        """Inverse mass M⁻¹ of each body by itself, (n, d, d) and (n, k, k)."""
        width, d = self._velocity.shape[1], self._own[0].shape[1]
        linear, angular = self._own[0].copy(), self._own[1].copy()
        body, component = np.divmod(self._model.velocities, width)
        inverse_mass = self._model.inverse_mass
        first, second = np.nonzero(body[:, None] == body[None, :])
        straight = (component[first] < d) & (component[second] < d)
        turning = (component[first] >= d) & (component[second] >= d)
        i, j = first[straight], second[straight]
        linear[body[i], component[i], component[j]] = inverse_mass[i, j]
        i, j = first[turning], second[turning]
        angular[body[i], component[i] - d, component[j] - d] = inverse_mass[i, j]
        return linear, angular


class _Decayed(NamedTuple):
    """Factors of a kick for a ``time``, kept for the next one, which is mostly as long: the ``share`` e⁻ᶻ that is left
    of modes, z = λt, and what they have ``gained`` by a constant force, t φ₁, and by a ``growing`` one, t² φ₂."""

    time: float
    share: FloatArray
    gained: FloatArray
    growing: FloatArray

    @classmethod
    def after(cls, time: float, rate: FloatArray) -> Self:
        """Factors for decay rates λ (c,) [1/time]."""
        decay = rate * time
        return cls(time, np.exp(-decay), time * _phi(decay), time**2 * _growing_phi(decay))


class _Friction:
    """Integrals over time t of modes y that start at zero: ∫ dt, ∫ y dt, ∫ t y dt and ∫ y² dt."""

    def __init__(self, integrals: FloatArray, time: float = 0.0) -> None:
        self._time = time
        self._way, self._moment, self._square = integrals

    def with_time(self, kicked: float) -> tuple[FloatArray, FloatArray]:
        """The times ``kicked`` and drifted (2,), and copies of the last three integrals (3, c)."""
        return np.array([kicked, self._time]), np.stack([self._way, self._moment, self._square])

    def add(self, modal: FloatArray, time: float) -> None:
        """Add a drift with velocities ``modal`` (c,) for ``time``."""
        self._way = self._way + time * modal
        self._moment = self._moment + (self._time + 0.5 * time) * time * modal
        self._square = self._square + time * modal**2
        self._time += time

    def beyond_linear(self, end: FloatArray, decay: FloatArray) -> float:
        """Sum Σ λ ∫ (y - y_end t/T)² dt."""
        if self._time == 0.0:
            return 0.0
        each = self._square - 2.0 * end * self._moment / self._time + end**2 * self._time / 3.0
        return float(decay @ np.maximum(each, 0.0))

    def left_out(self, end: FloatArray, decay: FloatArray) -> float:
        """Sum T/6 Σ λ y_end²."""
        return float(self._time * (decay @ end**2) / 6.0)

    def beyond_simpson(
        self, end: FloatArray, decay: FloatArray, start: FloatArray, resisting: tuple[FloatArray, FloatArray]
    ) -> float:
        """Integral ∫ (f₀ + t f₁ + λ y)·(u + y) dt, u (c,) at the ``start``, less its Simpson's rule for
        y = y_end t/T."""
        (first, growth), time = resisting, self._time
        last, middle, final = first + time * growth, start + 0.5 * end, start + end
        path = first @ (time * start + self._way) + growth @ (0.5 * time**2 * start + self._moment)
        path += decay @ (start * self._way + self._square)
        midway = first + 0.5 * time * growth
        seen = first @ start + 4.0 * (midway + 0.5 * decay * end) @ middle + (last + decay * end) @ final
        return float(path - time * seen / 6.0)


def _phi(decay: FloatArray) -> FloatArray:
    """Function φ₁ = (1 - e⁻ᶻ)/z, 1 at zero."""
    small = decay < 1e-8
    safe = np.where(small, 1.0, decay)
    return np.where(small, 1.0 - 0.5 * decay, -np.expm1(-safe) / safe)


def _growing_phi(decay: FloatArray) -> FloatArray:
    """Function φ₂ = (1 - φ₁)/z, a half at zero."""
    small = decay < 1e-4
    safe = np.where(small, 1.0, decay)
    return np.where(small, 0.5 - decay / 6.0 + decay**2 / 24.0, (1.0 - _phi(safe)) / safe)
