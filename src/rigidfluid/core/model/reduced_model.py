"""Reduced model of a few bodies in a fluid, and of their response to contacts within a step: mass and resistance
matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Conditions under which the impulse response of some velocities was evaluated: ``film_resistance`` (c,) of
    their contacts [1], and the ``velocity`` (c,) itself."""

    film_resistance: FloatArray
    velocity: FloatArray

    @property
    def arrays(self) -> tuple[FloatArray, FloatArray]:
        """Film resistance and velocity."""
        return self.film_resistance, self.velocity


@dataclass(frozen=True, slots=True)
class ReducedModel:
    """M dU/dt + R (U - Uⁿ) = Φ + F of some velocities U among those of all bodies.

    M is the mass of bodies and fluid, R what viscosity adds in a step, Φ all forces but the contacts' F. Both are
    known by their common ``modes`` X (c, c), XᵀMX = 1, and the ``decay`` rates λ (c,) in XᵀRX = diag λ [1/time].
    ``velocities`` (c,): their numbers among the components (N, d+k) of all motions' twists. ``evaluation``: conditions
    when their responses were evaluated. ``shared``: whether far bodies shared right sides in that.
    """

    velocities: IntArray
    modes: FloatArray
    decay: FloatArray
    evaluation: Evaluation
    shared: bool

    @property
    def inverse_mass(self) -> FloatArray:
        """M⁻¹ = X Xᵀ, (c, c) [1/mass]."""
        return self.modes @ self.modes.T

    def components(self, field: FloatArray) -> FloatArray:
        """Components (c,) that the model has of a ``field`` (N, d+k) of the motions."""
        return np.asarray(field.ravel()[self.velocities])

    def mass_times(self, velocity: FloatArray) -> FloatArray:
        """M U for U (c,)."""
        inverse = np.linalg.inv(self.modes)
        return np.asarray(inverse.T @ (inverse @ velocity))

    def response(self, d0: float, impulse: FloatArray) -> FloatArray:
        """d₀ (d₀M + R)⁻¹ J for J (c, …): velocities that impulses give, at the end of a BDF step."""
        share = 1.0 / (1.0 + self.decay / d0)
        return np.asarray((self.modes * share) @ (self.modes.T @ impulse))

    def friction_times(self, velocity: FloatArray) -> FloatArray:
        """R U for U (c,)."""
        inverse = np.linalg.inv(self.modes)
        return np.asarray(inverse.T @ (self.decay * (inverse @ velocity)))


@dataclass(frozen=True, slots=True)
class Coupling:
    """Coupling of the bodies near contacts with the fluid in one step: the reduced ``model``, and ``load`` (c,), its
    non-contact load Φ at the end of the step [force | force·length].

    ``load_before`` (c,) is Φ at its start, NaN where it is not known. ``correction`` (c,): of a fluid without inertia,
    the load that takes its response to the end of the path; it responds to the force there, and not to the mean of
    the step.
    """

    model: ReducedModel
    load: FloatArray
    load_before: FloatArray
    correction: FloatArray


def uncoupled() -> Coupling:
    """The coupling of no body at all."""
    none = np.zeros(0)
    model = ReducedModel(np.zeros(0, dtype=np.int64), np.zeros((0, 0)), none, Evaluation(none, none), False)
    return Coupling(model, none, none, none)


def reduced_model(
    velocities: IntArray, inviscid: FloatArray, viscous: FloatArray, d0: float, evaluation: Evaluation, shared: bool
) -> ReducedModel:
    """Reduced model of the impulse responses W_i = ``inviscid``, at once, and W_s = ``viscous``, at the end of a BDF
    step, (c, c) each, twists by unit impulses [1/mass].

    M = W_i⁻¹ and R = d₀ (W_s⁻¹ - W_i⁻¹), so that d₀M + R is the step's own response, with d₀ the weight of the newest
    velocity in its time derivative [1/time]. Both are made symmetric, which W_s is not where the fluid convects; where
    R would be negative it is zero. If far bodies ``shared`` right sides, their errors may leave modes no response at
    all, or a negative one.
    """
    mass_modes = _root(0.5 * (inviscid + inviscid.T), shared)  # L Lᵀ = W_i: XᵀMX = 1 for X = L
    response = np.linalg.solve(mass_modes, np.linalg.solve(mass_modes, 0.5 * (viscous + viscous.T)).T)
    share, turn = np.linalg.eigh(0.5 * (response + response.T))
    floor = _LEAST_SHARE * float(np.min(viscous.diagonal() / inviscid.diagonal())) if shared else _LEAST
    decay = d0 * np.maximum(1.0 / np.maximum(share, floor) - 1.0, 0.0)
    return ReducedModel(velocities, mass_modes @ turn, decay, evaluation, shared)


def _root(matrix: FloatArray, shared: bool) -> FloatArray:
    """L with L Lᵀ the matrix, of velocities and angular velocities: each counts in units of its own response."""
    unit = np.sqrt(matrix.diagonal())
    value, vector = np.linalg.eigh(matrix / np.outer(unit, unit))
    floor = _LEAST_SHARE if shared else _LEAST * value.max()
    return np.asarray(unit[:, None] * vector * np.sqrt(np.maximum(value, floor)))


_LEAST = 1e-12
"""Least share of the inviscid response; less is the rounding of none."""

_LEAST_SHARE = 0.1
"""Least response of a mode of many velocities, over those of single ones, where right sides were shared."""


def load_within(
    model: ReducedModel,
    derivative: FloatArray,
    twists: tuple[FloatArray, FloatArray, FloatArray],
    impulses: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Load Φ = M (d₀Uⁿ⁺¹ + d₁Uⁿ + d₂Uⁿ⁻¹) + R (Uⁿ⁺¹ - Uⁿ) - d₀Jⁿ⁺¹ + d₂Jⁿ (c,), all but the contacts, read from a
    solved step [force | force·length].

    ``derivative`` (3,): d₀, d₁, d₂ [1/time]; ``twists``: the model's velocities Uⁿ⁺¹, Uⁿ, Uⁿ⁻¹; ``impulses``: Jⁿ⁺¹, Jⁿ.
    The fluid's Uⁿ⁺¹ is linear in J by W_s, so that Φ does not depend on J.
    """
    d0, d1, d2 = derivative
    new, now, past = twists
    inertia = model.mass_times(d0 * new + d1 * now + d2 * past)
    return np.asarray(inertia + model.friction_times(new - now) - d0 * impulses[0] + d2 * impulses[1])


def mean_load(model: ReducedModel, change: FloatArray, impulse: FloatArray, step: float) -> FloatArray:
    """Load Φ ≈ [M (Uⁿ - Uⁿ⁻¹) - Jⁿ]/Δt - R (Uⁿ - Uⁿ⁻¹)/2 (c,) in the mean of the latest ``step`` Δt [force |
    force·length].

    ``change`` (c,): Uⁿ - Uⁿ⁻¹; ``impulse`` (c,): Jⁿ, which contacts gave then.
    """
    return np.asarray((model.mass_times(change) - impulse) / step - 0.5 * model.friction_times(change))
