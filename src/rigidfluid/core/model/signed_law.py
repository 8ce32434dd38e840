"""A law in contacts of both signs."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts, Motion


class SignedLaw(ForceLaw):
    """s F, s U and s k of a ``law`` in contacts of the sign s, and s times what its dampers and springs give."""

    name: ClassVar[str] = "signed"

    def __init__(self, law: ForceLaw) -> None:
        super().__init__(law.options, law.range, law.loads)
        self.law = law
        self.loads = law.loads
        self.film = law.film
        self.conservative = law.conservative
        self.dissipative = law.dissipative
        self.sticking = law.sticking
        self.sign = law.sign
        self.overlap = law.overlap
        self.vanishes_at_range = law.vanishes_at_range
        self.friction = law.friction

    @property
    def ranges(self) -> tuple[float, ...]:
        """Ranges of the law [length]."""
        return self.law.ranges

    def force(self, contacts: Contacts) -> FloatArray:
        """s F on ``body_a``, (m, d) [force]."""
        return contacts.sign[:, None] * self.law.force(contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        """s U, (m,) [energy]."""
        return contacts.sign * self.law.energy(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """s k, (m,) [force/length]."""
        return contacts.sign * self.law.stiffness(contacts)

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """s times the dampers' force on ``body_a``, (m, d) [force]."""
        return contacts.sign[:, None] * self.law.damping(contacts, motion)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """s k of the springs along the surfaces, (m,) [force/length]."""
        return contacts.sign * self.law.tangential_stiffness(contacts)

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """Displacement of these springs that friction holds, (m, d) [length]."""
        return np.asarray(self.law.held_displacement(contacts, motion, displacement))
