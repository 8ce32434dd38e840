"""A law in contacts of both signs."""

from __future__ import annotations

from typing import ClassVar

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.core.model.wrapped_law import WrappedLaw


class SignedLaw(WrappedLaw):
    """s F, s U and s k of a law in contacts of the sign s, and s times what its dampers and springs give."""

    name: ClassVar[str] = "signed"

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

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """s times the dampers' couple on ``body_a``, (m, k) [force·length]."""
        return contacts.sign[:, None] * self.law.couple(contacts, motion)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """s k of the springs along the surfaces, (m,) [force/length]."""
        return contacts.sign * self.law.tangential_stiffness(contacts)
