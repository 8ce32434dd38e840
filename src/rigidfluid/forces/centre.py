"""The paper's law for balls: a force along the line of centres."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rigidfluid.core.contact.laws.balls import require_balls
from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.pair_formula import PairFormula
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts


class CentreOptions(RepulsionOptions):
    """Keys of a table with law ``centre``; ε is in length³/force."""


class CentreLaw(Repulsion):
    """F = (1/ε)(x_i - x_j)(range - gap)² for gap ≤ range, of length (R + gap)(range - gap)²/ε, R = r_i + r_j.

    For a wall x_j is the centre of the tangent imaginary ball, so that R = 2r. The energy, with w = range - gap, is
    U = [(R + range) w³/3 - w⁴/4]/ε, the stiffness [2 (R + gap) w - w²]/ε. All hold for overlap as well, until the
    centres meet.

    A surface that is neither round nor flat raises SceneError.

    Notes
    -----
    Van Landeghem et al., arXiv 2402.19093, the short-range model for spheres.
    """

    name: ClassVar[str] = "centre"
    balls_only: ClassVar[bool] = True
    Options: ClassVar[type[PartOptions]] = CentreOptions

    def unit_force(self, contacts: Contacts) -> FloatArray:
        """(R + gap) w², (m,) [length³]."""
        return (_touching_distance(contacts) + contacts.gap) * self.closeness(contacts) ** 2

    def unit_energy(self, contacts: Contacts) -> FloatArray:
        """(R + range) w³/3 - w⁴/4, (m,) [length⁴]."""
        closeness = self.closeness(contacts)
        return (_touching_distance(contacts) + self.range) * closeness**3 / 3 - closeness**4 / 4

    def unit_stiffness(self, contacts: Contacts) -> FloatArray:
        """2 (R + gap) w - w², (m,) [length²]."""
        closeness = self.closeness(contacts)
        return closeness * (2.0 * (_touching_distance(contacts) + contacts.gap) - closeness)

    def pair_formula(self) -> PairFormula | None:
        """(R + gap) w²/ε."""
        return self.formula(_formula)


def _touching_distance(contacts: Contacts) -> FloatArray:
    """R = r_i + r_j, the distance of the centres where the surfaces touch, (m,) [length]."""
    require_balls(contacts, CentreLaw.name)
    return contacts.radius_a + np.where(contacts.at_wall, contacts.radius_a, contacts.radius_b)


def _formula(parameters, gap, radius_a, radius_b, mass, opening, sliding):  # type: ignore[no-untyped-def]
    """Energy and force of one contact: it is compiled."""
    closeness, wall = max(parameters[0] - gap, 0.0), np.isinf(radius_b)
    epsilon = parameters[2] if wall else parameters[1]
    touching = radius_a + (radius_a if wall else radius_b)
    energy = (touching + parameters[0]) * closeness**3 / 3 - closeness**4 / 4
    return energy / epsilon, (touching + gap) * closeness**2 / epsilon, 0.0, 0.0
