"""A law for any shape that no finite energy overcomes."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from rigidfluid.core.contact.laws.repulsion import Repulsion, RepulsionOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.pair_formula import PairFormula
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import StepRejected


class BarrierOptions(RepulsionOptions):
    """Keys of a table with law ``barrier``; ε is in length/force."""


class BarrierLaw(Repulsion):
    """U = -(1/ε)(gap - range)² ln(gap/range) for 0 < gap ≤ range, infinite at contact.

    With w = range - gap and l = ln(range/gap), F = [2 w l + w²/gap]/ε along the normal and the stiffness is
    [2 l + 4 w/gap + w²/gap²]/ε: U has two continuous derivatives at range.

    Force and stiffness raise StepRejected where the gap is not positive.

    Notes
    -----
    The barrier of incremental potential contact: Li et al., ACM Trans. Graph. 39 (2020) 49,
    doi:10.1145/3386569.3392425.
    """

    name: ClassVar[str] = "barrier"
    overlap: Literal["repels", "attracts", "unbounded"] = "unbounded"
    Options: ClassVar[type[PartOptions]] = BarrierOptions

    def unit_force(self, contacts: Contacts) -> FloatArray:
        """2 w l + w²/gap, (m,) [length]."""
        _refuse_overlap(contacts)
        closeness = self.closeness(contacts)
        # log1p, since the logarithm of a ratio near one loses digits
        return closeness * (2.0 * np.log1p(closeness / contacts.gap) + closeness / contacts.gap)

    def unit_energy(self, contacts: Contacts) -> FloatArray:
        """w² l, (m,), infinite where the gap is not positive [length²]."""
        closeness = self.closeness(contacts)
        ratio = np.full(len(contacts), np.inf)
        np.divide(closeness, contacts.gap, out=ratio, where=contacts.gap > 0.0)
        return np.asarray(closeness**2 * np.log1p(ratio))

    def unit_stiffness(self, contacts: Contacts) -> FloatArray:
        """2 l + 4 w/gap + w²/gap², (m,) [1]."""
        _refuse_overlap(contacts)
        ratio = self.closeness(contacts) / contacts.gap
        return 2.0 * np.log1p(ratio) + ratio * (4.0 + ratio)

    def pair_formula(self) -> PairFormula | None:
        """[2 w l + w²/gap]/ε."""
        return self.formula(_formula)


def _formula(parameters, gap, radius_a, radius_b, mass, opening, sliding):  # type: ignore[no-untyped-def]
    """Energy and force of one contact: it is compiled."""
    closeness, epsilon = max(parameters[0] - gap, 0.0), parameters[2] if np.isinf(radius_b) else parameters[1]
    if gap <= 0.0:
        return np.inf, np.nan, 0.0, 0.0
    logarithm, ratio = np.log1p(closeness / gap), closeness / gap
    return closeness**2 * logarithm / epsilon, closeness * (2.0 * logarithm + ratio) / epsilon, 0.0, 0.0


def _refuse_overlap(contacts: Contacts) -> None:
    if np.all(contacts.gap > 0.0):
        return
    first = int(np.argmin(contacts.gap))
    raise StepRejected(
        f"surfaces {contacts.body_a[first]} and {contacts.body_b[first]}",
        f"a gap of {contacts.gap[first]:.3e}",
        "a positive gap with the barrier law",
        "Shorten the step.",
    )
