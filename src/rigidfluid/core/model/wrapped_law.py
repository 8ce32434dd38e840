"""Laws around another law, from which they differ in a part alone."""

from __future__ import annotations

from typing import TypeVar

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Motion


class WrappedLaw(ForceLaw):
    """Law that is and declares what its ``law`` does, up to what a subclass changes."""

    def __init__(self, law: ForceLaw) -> None:
        super().__init__(law.options, law.range, law.loads)
        self.law = law
        self.loads = law.loads
        self.film = law.film
        self.curved = law.curved
        self.round_option = law.round_option
        self.acts_in = law.acts_in
        self.conservative = law.conservative
        self.dissipative = law.dissipative
        self.sticking = law.sticking
        self.rolling = law.rolling
        self.couples = law.couples
        self.sign = law.sign
        self.overlap = law.overlap
        self.vanishes_at_range = law.vanishes_at_range
        self.friction = law.friction

    @property
    def ranges(self) -> tuple[float, ...]:
        """Ranges of the law [length]."""
        return self.law.ranges

    def force(self, contacts: Contacts) -> FloatArray:
        """Force of the law on ``body_a``, (m, d) [force]."""
        return self.law.force(contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        """Energy of the law, (m,) [energy]."""
        return self.law.energy(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness of the law, (m,) [force/length]."""
        return self.law.stiffness(contacts)

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Damping of the law on ``body_a``, (m, d) [force]."""
        return self.law.damping(contacts, motion)

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Couples of the law on ``body_a``, (m, k) [force·length]."""
        return self.law.couple(contacts, motion)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness of the law's springs along the surfaces, (m,) [force/length]."""
        return self.law.tangential_stiffness(contacts)

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """Displacement of these springs that friction holds, (m, d) [length]."""
        return self.law.held_displacement(contacts, motion, displacement)

    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """Displacement of these springs by rolling and twisting that friction holds, (m, k) [length]."""
        return self.law.held_turning(contacts, motion, turning)


W = TypeVar("W", bound=WrappedLaw)


def bare(law: ForceLaw) -> ForceLaw:
    """Law that gives force and energy, without all that is around it."""
    while isinstance(law, WrappedLaw):
        law = law.law
    return law


def layer(kind: type[W], law: ForceLaw) -> W | None:
    """Law of a ``kind`` on the way to the bare law, None without one."""
    while isinstance(law, WrappedLaw):
        if isinstance(law, kind):
            return law
        law = law.law
    return None
