"""Laws that add a force to that of another law, which keeps its energy."""

from __future__ import annotations

from typing import TypeVar

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts


class AddedLaw(ForceLaw):
    """Law that adds damping to a ``law``, and has the energy of that one."""

    dissipative: bool = True

    def __init__(self, law: ForceLaw) -> None:
        super().__init__(law.options, law.range, law.loads)
        self.law = law
        self.loads = law.loads
        self.sign = law.sign
        self.overlap = law.overlap
        self.vanishes_at_range = law.vanishes_at_range
        self.film = law.film

    @property
    def ranges(self) -> tuple[float, ...]:
        """Ranges of the law [length]."""
        return self.law.ranges

    def force(self, contacts: Contacts) -> FloatArray:
        """Force f of the law on ``body_a``, (m, d) [force]."""
        return self.law.force(contacts)

    def energy(self, contacts: Contacts) -> FloatArray:
        """Energy U of the law, (m,) [energy]."""
        return self.law.energy(contacts)

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Stiffness of the law, (m,) [force/length]."""
        return self.law.stiffness(contacts)


A = TypeVar("A", bound=AddedLaw)


def bare(law: ForceLaw) -> ForceLaw:
    """Law that gives force and energy, without all that is added to it."""
    while isinstance(law, AddedLaw):
        law = law.law
    return law


def added(kind: type[A], law: ForceLaw) -> A | None:
    """Added law of a ``kind`` on the way to the bare law, None without one."""
    while isinstance(law, AddedLaw):
        if isinstance(law, kind):
            return law
        law = law.law
    return None
