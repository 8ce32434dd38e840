"""Interactions between surfaces: a list, each a law with the contacts that are its own; forces add up."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import Between, ForceLaw, Overlap, Sign
from rigidfluid.core.model.latest import Latest
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Motion


@dataclass(frozen=True)
class Interaction:
    """A law, and the contacts that it acts in.

    ``field``: the scene's table that names it. ``between``: contacts at walls, of pairs of bodies, or both; of these it
    acts in the ones that one of each group of ``surfaces`` takes part in: in all if there is no group, with two in
    those between them alone. ``smallest_gap``: what the scene asks for, None if nothing [length].
    """

    field: str
    law: ForceLaw
    between: Between
    surfaces: tuple[tuple[int, ...], ...]
    smallest_gap: float | None = None

    def acts_in(self, contacts: Contacts) -> BoolArray:
        """Tell whether each contact is its own, whatever the gap, (m,)."""
        chosen = np.ones(len(contacts), dtype=bool)
        if self.between != "all":
            chosen &= contacts.at_wall == (self.between == "walls")
        if not self.surfaces:
            return chosen
        a, b = ([np.isin(side, group) for group in self.surfaces] for side in (contacts.body_a, contacts.body_b))
        if len(self.surfaces) == 1:
            chosen &= a[0] | b[0]
        if len(self.surfaces) == 2:
            chosen &= (a[0] & b[1]) | (a[1] & b[0])
        return chosen


_Share = tuple[Interaction, Contacts, BoolArray]


def acted_in(interactions: Sequence[Interaction], contacts: Contacts) -> BoolArray:
    """Tell whether any of the interactions acts in each contact, (m,)."""
    chosen = np.zeros(len(contacts), dtype=bool)
    for interaction in interactions:
        chosen |= interaction.acts_in(contacts)
    return chosen


def acting_together(interactions: Sequence[Interaction]) -> ForceLaw | None:
    """Law of some interactions together: one that acts everywhere is its own law, none is None."""
    if not interactions:
        return None
    first = interactions[0]
    if len(interactions) == 1 and first.between == "all" and not first.surfaces:
        return first.law
    return SumOfLaws(interactions)


class SumOfLaws(ForceLaw):
    """F = Σ F_l, U = Σ U_l, k = Σ k_l over the laws l of the interactions, at least one, that act in a contact.

    Its range is the longest. It is conservative and dissipative if any law is. It repels, or attracts, if all laws with
    an energy do; in overlap it is unbounded if any law is, and counted on to repel only if all laws with an energy do.
    """

    name: ClassVar[str] = "sum"

    def __init__(self, interactions: Sequence[Interaction]) -> None:
        laws = [interaction.law for interaction in interactions]
        super().__init__(PartOptions(), max(law.range for law in laws))
        self.interactions = tuple(interactions)
        self.conservative = any(law.conservative for law in laws)
        self.dissipative = any(law.dissipative for law in laws)
        with_energy = [law for law in laws if law.conservative]
        self.sign = _sign_of(with_energy)
        self.overlap = _overlap_of(with_energy)
        self.vanishes_at_range = all(law.vanishes_at_range for law in with_energy)
        self.sticking = any(law.sticking for law in laws)
        self.rolling = any(law.rolling for law in laws)
        self.couples = any(law.couples for law in laws)
        self._shared, self._parts = Latest[list[_Share]](), Latest[list[tuple[BoolArray, Motion]]]()

    @property
    def ranges(self) -> tuple[float, ...]:
        """The ranges of all laws, in order [length]."""
        return tuple(sorted({gap for interaction in self.interactions for gap in interaction.law.ranges}))

    def force(self, contacts: Contacts) -> FloatArray:
        """Σ F_l on ``body_a``, (m, d) [force]."""
        return self._sum(contacts, np.zeros_like(contacts.normal), lambda law, some, _: law.force(some))

    def energy(self, contacts: Contacts) -> FloatArray:
        """Σ U_l, (m,) [energy]."""
        return self._sum(contacts, np.zeros_like(contacts.gap), lambda law, some, _: law.energy(some))

    def stiffness(self, contacts: Contacts) -> FloatArray:
        """Σ k_l, (m,) [force/length]."""
        return self._sum(contacts, np.zeros_like(contacts.gap), lambda law, some, _: law.stiffness(some))

    def damping(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Σ of what the laws' dampers add on ``body_a``, (m, d) [force]."""

        def damping(law: ForceLaw, some: Contacts, chosen: BoolArray) -> FloatArray:
            return law.damping(some, self._part(motion, chosen))

        return self._sum(contacts, np.zeros_like(contacts.normal), damping)

    def couple(self, contacts: Contacts, motion: Motion) -> FloatArray:
        """Σ of the laws' couples on ``body_a``, (m, k) [force·length]."""

        def couple(law: ForceLaw, some: Contacts, chosen: BoolArray) -> FloatArray:
            return law.couple(some, self._part(motion, chosen))

        return self._sum(contacts, np.zeros_like(motion.angular_velocity), couple)

    def tangential_stiffness(self, contacts: Contacts) -> FloatArray:
        """Σ k of the springs along the surfaces, (m,) [force/length]: one law at most has some in a contact."""
        return self._sum(contacts, np.zeros_like(contacts.gap), lambda law, some, _: law.tangential_stiffness(some))

    def held_displacement(self, contacts: Contacts, motion: Motion, displacement: FloatArray) -> FloatArray:
        """Displacement of these springs that friction holds, (m, d) [length]."""

        def held(law: ForceLaw, some: Contacts, chosen: BoolArray) -> FloatArray:
            return law.held_displacement(some, self._part(motion, chosen), displacement[chosen])

        return self._sum(contacts, np.zeros_like(displacement), held)

    def held_turning(self, contacts: Contacts, motion: Motion, turning: FloatArray) -> FloatArray:
        """Displacement of these springs by rolling and twisting that friction holds, (m, k) [length]."""

        def held(law: ForceLaw, some: Contacts, chosen: BoolArray) -> FloatArray:
            return law.held_turning(some, self._part(motion, chosen), turning[chosen])

        return self._sum(contacts, np.zeros_like(turning), held)

    def _sum(
        self, contacts: Contacts, total: FloatArray, asked: Callable[[ForceLaw, Contacts, BoolArray], FloatArray]
    ) -> FloatArray:
        for interaction, some, chosen in self._shares(contacts):
            total[chosen] += asked(interaction.law, some, chosen)
        return total

    def _part(self, motion: Motion, chosen: BoolArray) -> Motion:
        """Motion in some of the contacts, the same record for the same choice: laws may keep what they computed."""
        parts = self._parts.answer((motion,), list)
        for known, part in parts:
            if known is chosen:
                return part
        parts.append((chosen, motion.select(chosen)))
        return parts[-1][1]

    def _shares(self, contacts: Contacts) -> list[_Share]:
        """Each interaction that acts here, its contacts, and which they are; kept for the same contacts."""
        return self._shared.answer((contacts,), lambda: list(self._divided(contacts)))

    def _divided(self, contacts: Contacts) -> Iterator[_Share]:
        for interaction in self.interactions:
            chosen = interaction.acts_in(contacts)
            if chosen.any():
                yield interaction, select(contacts, chosen), chosen


def _sign_of(laws: Sequence[ForceLaw]) -> Sign:
    found = {law.sign for law in laws}
    return found.pop() if len(found) == 1 else "either" if found else "repels"


def _overlap_of(laws: Sequence[ForceLaw]) -> Overlap:
    found = {law.overlap for law in laws}
    for overlap in ("unbounded", "either", "attracts"):
        if overlap in found:
            return overlap
    return "repels"
