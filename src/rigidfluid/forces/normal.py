"""A law for any shape that grows all the way: a force along the unit normal."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.pair_formula import PairFormula
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts


class NormalOptions(RepulsionOptions):
    """Keys of a table with law ``normal``; ε is in length²/force."""


class NormalLaw(Repulsion):
    """F = (1/ε)(range - gap)² n for gap ≤ range, and on in overlap.

    With w = range - gap, U = w³/(3 ε) and the stiffness is 2 w/ε.

    Notes
    -----
    The laws of Van Landeghem et al., arXiv 2402.19093, with a vector of length one in place of theirs.
    """

    name: ClassVar[str] = "normal"
    Options: ClassVar[type[PartOptions]] = NormalOptions

    def unit_force(self, contacts: Contacts) -> FloatArray:
        """w², (m,) [length²]."""
        return self.closeness(contacts) ** 2

    def unit_energy(self, contacts: Contacts) -> FloatArray:
        """w³/3, (m,) [length³]."""
        return self.closeness(contacts) ** 3 / 3

    def unit_stiffness(self, contacts: Contacts) -> FloatArray:
        """2 w, (m,) [length]."""
        return 2.0 * self.closeness(contacts)

    def pair_formula(self) -> PairFormula | None:
        """w²/ε."""
        return self.formula(_formula)


def _formula(parameters, gap, radius_a, radius_b, mass, opening, sliding):  # type: ignore[no-untyped-def]
    """Energy and force of one contact: it is compiled."""
    closeness, wall = max(parameters[0] - gap, 0.0), np.isinf(radius_b)
    epsilon = parameters[2] if wall else parameters[1]
    return closeness**3 / 3 / epsilon, closeness**2 / epsilon, 0.0, 0.0
