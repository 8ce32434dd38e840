"""Coulomb's friction with memory, for any law that repels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from rigidfluid.core.contact.laws.restitution import Restitution
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.coulomb import (
    Bedding,
    TurningFriction,
    dashpot_coefficient,
    held_displacement,
    sliding_friction,
)
from rigidfluid.core.model.contacts import normal_part, tangential_part
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.core.model.wrapped_law import WrappedLaw, layer
from rigidfluid.errors import SceneError

STIFFNESS_RATIO = 2.0 / 7.0
"""Tangential over normal stiffness: spheres then swing as fast along the surfaces, where they turn too, as across
them."""


@dataclass(frozen=True, slots=True)
class Rubbing:
    """Numbers of friction: the coefficient ``friction`` μ [1]; ``stiffness`` k_t of springs along the surfaces, None
    for the share STIFFNESS_RATIO of the law's own up to the ``gap`` [length] to which impacts press [force/length];
    ``damping`` x, the ratio of the dashpots' coefficient to the one with the dry restitution [1]; the friction of
    ``turning``."""

    friction: float
    stiffness: float | None
    damping: float
    gap: float
    turning: TurningFriction


class Friction(WrappedLaw):
    """Law F = F_n n - k_t ξ - min(x γ |v_t|, μ |F_n|) v_t/|v_t|, the force along the surfaces at most μ |F_n|.

    F_n is the normal force of a ``law``, its dampers included. ξ is the displacement of the surfaces past each other
    since they touch, shortened where they slip until the bound holds (Cundall and Strack, Géotechnique 29 (1979) 47,
    doi:10.1680/geot.1979.29.1.47). γ = -2 ln e √(m k_t/(π² + ln² e)), with the dry restitution e of the law and the
    effective mass m; it is zero without a restitution. If not given, k_t is 2/7 of the law's force at the smallest gap
    wanted over the way from range to there: impacts of a sphere then have one period in both directions (Schäfer,
    Dippel and Wolf, J. Phys. I 6 (1996) 5, doi:10.1051/jp1:1996129).

    Friction of turning has the same springs and dashpots, see `TurningFriction`.

    SceneError is raised for a law that does not repel, or has a friction of its own, and without a given k_t for one
    that may not repel at the smallest gap.
    """

    name: ClassVar[str] = "friction"

    def __init__(self, law: ForceLaw, rubbing: Rubbing) -> None:
        super().__init__(law)
        if not law.keeps_apart:
            remedy = "Leave `friction` out, and give it to the law that repels."
            raise SceneError("contact.law", f"a friction for {law.name!r}", "a law that repels", remedy)
        if law.sticking or law.friction > 0.0:
            allowed = f"a law without a friction of its own, as {law.name!r} has"
            raise SceneError("contact.friction", rubbing.friction, allowed, "Remove it, or choose another law.")
        if law.sign == "either" and rubbing.stiffness is None:
            allowed = f"a stiffness with {law.name!r}, which may not repel at the smallest gap"
            raise SceneError("contact.tangential_stiffness", "none", allowed, "Add it.")
        self.dissipative = self.sticking = True
        self.friction = rubbing.friction
        self._rubbing, self._turning = rubbing, rubbing.turning
        self.rolling_friction, self.twisting_friction = rubbing.turning.rolling, rubbing.turning.twisting
        if rubbing.turning.keys:
            self.rolling = self.couples = True
            self.round_option = rubbing.turning.keys[0]
        restitution = layer(Restitution, law)
        self._restitution = 1.0 if restitution is None else restitution.restitution

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Damping of the law, and the dashpots along the surfaces on ``body_a``, (m, d) [force]."""
        damping = self.law.damping(contacts, motion)
        most = self._most(contacts, damping)
        return damping - self._dashpots(contacts, motion, self.tangential_stiffness(contacts), most)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """k_t within range, (m,) [force/length]."""
        given = self._rubbing.stiffness
        stiffness = self._share(contacts) if given is None else np.full_like(contacts.gap, given)
        return np.where(contacts.gap < self.range, stiffness, 0.0)

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """ξ with a force of at most μ |F_n|, the nearest along that force, (m, d) [length]."""
        most = self._most(contacts, self.law.damping(contacts, motion))
        stiffness = self.tangential_stiffness(contacts)
        return held_displacement(stiffness, self._dashpots(contacts, motion, stiffness, most), most, displacement)

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Couples of the law, and of dashpots that resist turning, on ``body_a``, (m, k) [force·length]."""
        return self.law.couple(contacts, motion) + self._turning.couple(
            contacts, motion, self._bedding(contacts, motion)
        )

    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """ζ with couples of at most μ_r R |F_n| and μ_o R |F_n|, (m, k) [length]."""
        return self._turning.held(contacts, motion, self._bedding(contacts, motion), turning)

    def _bedding(self, contacts: Contacts, motion: Motion) -> Bedding:
        normal_force = self._normal_force(contacts, self.law.damping(contacts, motion))
        stiffness = self.tangential_stiffness(contacts)
        return Bedding(stiffness, self._coefficient(stiffness, motion.mass), normal_force)

    def _share(self, contacts: Contacts) -> FloatArray:
        """STIFFNESS_RATIO of the force at the smallest gap, over the way from range to there, (m,) [force/length]."""
        gap = self._rubbing.gap
        pressed = replace(contacts, gap=np.full_like(contacts.gap, gap))
        force = np.maximum(normal_part(self.law.force(pressed), pressed), 0.0)
        return np.asarray(STIFFNESS_RATIO * force / (self.range - gap))

    def _most(self, contacts: Contacts, damping: FloatArray) -> FloatArray:
        """μ |F_n|, (m,) [force], with the law's ``damping`` (m, d)."""
        return self.friction * self._normal_force(contacts, damping)

    def _normal_force(self, contacts: Contacts, damping: FloatArray) -> FloatArray:
        """|F_n|, (m,) [force], with the law's ``damping`` (m, d)."""
        return np.abs(normal_part(self.law.force(contacts) + damping, contacts))

    def _dashpots(self, contacts: Contacts, motion: Motion, stiffness: FloatArray, most: FloatArray) -> FloatArray:
        """min(x γ |v_t|, ``most``) v_t/|v_t| beside springs of this ``stiffness`` (m,), (m, d) [force]."""
        coefficient = self._coefficient(stiffness, motion.mass)
        return sliding_friction(coefficient, most, tangential_part(motion.velocity, contacts))

    def _coefficient(self, stiffness: FloatArray, mass: FloatArray) -> FloatArray:
        """x γ beside springs of this ``stiffness`` (m,) between masses (m,), (m,) [force·time/length]."""
        return self._rubbing.damping * dashpot_coefficient(self._restitution, stiffness, mass)
