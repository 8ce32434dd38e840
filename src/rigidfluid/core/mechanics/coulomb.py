"""Coulomb's friction of a spring and a dashpot along surfaces, and against rolling and twisting; the dashpot of a
spring with a given restitution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Motion


def held_displacement(
    stiffness: FloatArray, damped: FloatArray, most: FloatArray, displacement: FloatArray
) -> FloatArray:
    """Part ξ (m, d) of a ``displacement`` (m, d) that friction holds, with |k ξ + f| ≤ ``most`` (m,) and k ξ + f along
    that of the whole displacement [length]; ``stiffness`` k (m,) [force/length], f = ``damped`` (m, d) [force]."""
    column = stiffness[:, None]
    whole = column * displacement + damped
    held = _shortened(most, whole)
    slipped = np.divide(held - damped, column, out=np.zeros_like(displacement), where=column > 0.0)
    sticks = np.all(held == whole, axis=1, keepdims=True) & (column > 0.0)
    return np.where(sticks, displacement, slipped)


def sliding_friction(coefficient: FloatArray, most: FloatArray, velocity: FloatArray) -> FloatArray:
    """Force min(γ |v|, ``most``) v/|v|, zero at rest, (m, d) [force]; ``coefficient`` γ (m,) [force·time/length]."""
    speed = np.linalg.norm(velocity, axis=1)
    ratio = np.minimum(coefficient, np.divide(most, speed, out=np.full_like(speed, np.inf), where=speed > 0.0))
    return np.asarray(ratio[:, None] * velocity)


def dashpot_coefficient(restitution: float, stiffness: FloatArray | float, mass: FloatArray) -> FloatArray:
    """Coefficient γ = -2 ln e √(m k/(π² + ln² e)) of the dashpot beside a spring, (m,), with which half a swing leaves
    e times the speed [force·time/length]."""
    logarithm = np.log(restitution)
    return np.asarray(-2.0 * logarithm * np.sqrt(mass * stiffness / (np.pi**2 + logarithm**2)))


@dataclass(frozen=True, slots=True)
class Bedding:
    """Springs along the surfaces and their bound: ``stiffness`` k_t (m,) [force/length], ``damping`` γ of the dashpots
    beside them (m,) [force·time/length], and the size of the ``normal_force`` (m,) [force]."""

    stiffness: FloatArray
    damping: FloatArray
    normal_force: FloatArray


@dataclass(frozen=True, slots=True)
class TurningFriction:
    """Couple C = -R (k_t ζ + γ R w), with |C across n| ≤ μ_r R |F_n| and |C along n| ≤ μ_o R |F_n|.

    μ_r is ``rolling``, μ_o ``twisting`` [1]; w is the relative angular velocity, R = r_a r_b/(r_a + r_b) the effective
    radius, and ζ = ∫ R w dt [length], shortened until the bounds hold (Luding, Granular Matter 10 (2008) 235,
    doi:10.1007/s10035-008-0099-x). A dashpot is limited to its bound before the spring, which in fast turning it would
    else stretch backwards. In 2D bodies roll and do not twist.
    """

    rolling: float
    twisting: float

    @property
    def keys(self) -> list[str]:
        """Keys of the table that ask for it."""
        parts = ("rolling_friction", self.rolling), ("twisting_friction", self.twisting)
        return [key for key, coefficient in parts if coefficient > 0.0]

    def couple(self, contacts: Contacts, motion: Motion, bedding: Bedding) -> FloatArray:
        """-γ R² w of what friction resists, at most what it holds, on ``body_a``, (m, k) [force·length]."""
        radius, none = contacts.effective_radius[:, None], np.zeros_like(motion.angular_velocity)
        damped = [force for _, force in self._dashpots(contacts, motion, bedding)]
        return np.asarray(-radius * sum(damped, none))

    def held(self, contacts: Contacts, motion: Motion, bedding: Bedding, turning: FloatArray) -> FloatArray:
        """ζ with |k_t ζ + γ R w| ≤ μ |F_n| along the normal and across it, with its own μ each, (m, k) [length]."""
        parts = zip(self._resisted(contacts, turning), self._dashpots(contacts, motion, bedding), strict=True)
        held = [held_displacement(bedding.stiffness, damped, most, part) for (_, part), (most, damped) in parts]
        return np.asarray(sum(held, np.zeros_like(turning)))

    def _dashpots(self, contacts: Contacts, motion: Motion, bedding: Bedding) -> list[tuple[FloatArray, FloatArray]]:
        """Bound μ |F_n| (m,) [force] of each part of the turning that friction resists, and γ R w (m, k) up to it
        [force]."""
        damping = bedding.damping * contacts.effective_radius
        resisted = self._resisted(contacts, motion.angular_velocity)
        bounds = [(coefficient * bedding.normal_force, spin) for coefficient, spin in resisted]
        return [(most, sliding_friction(damping, most, spin)) for most, spin in bounds]

    def _resisted(self, contacts: Contacts, turning: FloatArray) -> list[tuple[float, FloatArray]]:
        """Parts of ``turning`` (m, k) that friction resists, each with its coefficient: across and along the normal."""
        twisting = np.zeros_like(turning)
        if turning.shape[1] == 3:
            twisting = np.sum(turning * contacts.normal, axis=1)[:, None] * contacts.normal
        parts = (self.rolling, turning - twisting), (self.twisting, twisting)
        return [(coefficient, part) for coefficient, part in parts if coefficient > 0.0]


def _shortened(most: FloatArray, force: FloatArray) -> FloatArray:
    """Forces (m, d) shortened to ``most`` (m,) where they are longer."""
    size = np.linalg.norm(force, axis=1)
    part = np.divide(most, size, out=np.ones_like(size), where=size > most)
    return np.asarray(part[:, None] * force)
