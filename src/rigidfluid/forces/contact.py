"""The paper's law for any shape: a force along the line of the contact points."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.pair_formula import PairFormula
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts


class ContactPointOptions(RepulsionOptions):
    """Keys of a table with law ``contact``; ε is in length³/force."""


class ContactPointLaw(Repulsion):
    """F = (1/ε)(X_i - X_j)(range - gap)² for gap ≤ range, of length gap (range - gap)²/ε.

    X_i, X_j are the contact points, gap · n apart. With w = range - gap, U = [range w³/3 - w⁴/4]/ε and the stiffness is
    [2 gap w - w²]/ε. The force is largest at gap = range/3, 4 range³/(27 ε), and vanishes at contact, where the energy
    is range⁴/(12 ε): bodies with more energy than that overlap. There the formula is taken as it stands, so that force
    and energy have no kink: the vector turns round, and the force pulls the bodies together.

    Notes
    -----
    Van Landeghem et al., arXiv 2402.19093, the short-range model for other shapes.

    With ``auto`` a body turns at the smallest gap if the force there is at least its weight, which is so for a
    smallest gap from range/9 on. Below that the law cannot turn a slow and heavy body so near to contact, and it turns
    earlier.
    """

    name: ClassVar[str] = "contact"
    overlap: Literal["repels", "attracts", "unbounded"] = "attracts"
    Options: ClassVar[type[PartOptions]] = ContactPointOptions

    def unit_force(self, contacts: Contacts) -> FloatArray:
        """gap w², (m,) [length³]."""
        return contacts.gap * self.closeness(contacts) ** 2

    def unit_energy(self, contacts: Contacts) -> FloatArray:
        """range w³/3 - w⁴/4, (m,) [length⁴]."""
        closeness = self.closeness(contacts)
        return self.range * closeness**3 / 3 - closeness**4 / 4

    def unit_stiffness(self, contacts: Contacts) -> FloatArray:
        """2 gap w - w², (m,) [length²]."""
        closeness = self.closeness(contacts)
        return closeness * (2.0 * contacts.gap - closeness)

    def pair_formula(self) -> PairFormula | None:
        """gap w²/ε."""
        return self.formula(_formula)


def _formula(parameters, gap, radius_a, radius_b, mass, opening, sliding):  # type: ignore[no-untyped-def]
    """Energy and force of one contact: it is compiled."""
    closeness, wall = max(parameters[0] - gap, 0.0), np.isinf(radius_b)
    epsilon = parameters[2] if wall else parameters[1]
    energy = parameters[0] * closeness**3 / 3 - closeness**4 / 4
    return energy / epsilon, gap * closeness**2 / epsilon, 0.0, 0.0
