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
from rigidfluid.core.model.latest import Latest
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


@dataclass(frozen=True, slots=True)
class _Pressed:
    """Forces in contacts: the law's ``damping`` (m, d) [force], the ``bedding`` of springs, ``most``, μ |F_n|, (m,)
    [force], and the ``dashpots`` min(x γ |v_t|, μ |F_n|) v_t/|v_t| (m, d) [force]."""

    damping: FloatArray
    bedding: Bedding
    most: FloatArray
    dashpots: FloatArray


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
        self._stiffness, self._pressed = Latest[FloatArray](), Latest[_Pressed]()

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Damping of the law, and the dashpots along the surfaces on ``body_a``, (m, d) [force]."""
        pressed = self._pressed_in(contacts, motion)
        return pressed.damping - pressed.dashpots

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """k_t within range, (m,) [force/length]."""
        return self._stiffness.answer((contacts,), lambda: self._stiffness_in(contacts))

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """ξ with a force of at most μ |F_n|, the nearest along that force, (m, d) [length]."""
        pressed = self._pressed_in(contacts, motion)
        return held_displacement(pressed.bedding.stiffness, pressed.dashpots, pressed.most, displacement)

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Couples of the law, and of dashpots that resist turning, on ``body_a``, (m, k) [force·length]."""
        bedding = self._pressed_in(contacts, motion).bedding
        return self.law.couple(contacts, motion) + self._turning.couple(contacts, motion, bedding)

    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """ζ with couples of at most μ_r R |F_n| and μ_o R |F_n|, (m, k) [length]."""
        return self._turning.held(contacts, motion, self._pressed_in(contacts, motion).bedding, turning)

    def ball_springs(self) -> tuple[float, ...]:
        """Numbers of the springs of balls, see `BallLaw`."""
        rubbing, turning = self._rubbing, self._turning
        stiffness = np.nan if rubbing.stiffness is None else rubbing.stiffness
        dashpot = rubbing.damping * float(dashpot_coefficient(self._restitution, 1.0, np.ones(1))[0])
        share = STIFFNESS_RATIO / (self.range - rubbing.gap)
        return stiffness, self.friction, turning.rolling, turning.twisting, 1.0, dashpot, rubbing.gap, share

    def _pressed_in(self, contacts: Contacts, motion: Motion) -> _Pressed:
        """Forces in the contacts, kept for the same records: each substep asks four times."""
        return self._pressed.answer((contacts, motion), lambda: self._press(contacts, motion))

    def _press(self, contacts: Contacts, motion: Motion) -> _Pressed:
        damping, stiffness = self.law.damping(contacts, motion), self.tangential_stiffness(contacts)
        normal_force = np.abs(normal_part(self.law.force(contacts) + damping, contacts))
        coefficient = self._rubbing.damping * dashpot_coefficient(self._restitution, stiffness, motion.mass)
        most = self.friction * normal_force
        dashpots = sliding_friction(coefficient, most, tangential_part(motion.velocity, contacts))
        return _Pressed(damping, Bedding(stiffness, coefficient, normal_force), most, dashpots)

    def _stiffness_in(self, contacts: Contacts) -> FloatArray:
        given = self._rubbing.stiffness
        stiffness = self._share(contacts) if given is None else np.full_like(contacts.gap, given)
        return np.where(contacts.gap < self.range, stiffness, 0.0)

    def _share(self, contacts: Contacts) -> FloatArray:
        """STIFFNESS_RATIO of the force at the smallest gap, over the way from range to there, (m,) [force/length]."""
        gap = self._rubbing.gap
        pressed = replace(contacts, gap=np.full_like(contacts.gap, gap))
        force = np.maximum(normal_part(self.law.force(pressed), pressed), 0.0)
        return np.asarray(STIFFNESS_RATIO * force / (self.range - gap))
