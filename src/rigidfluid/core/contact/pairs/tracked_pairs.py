"""Contacts of one pose, detected again at others."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.contact.pairs.image_codes import image_codes
from rigidfluid.core.contact.pairs.proximity import detect, interacting, travel
from rigidfluid.core.contact.pairs.same_contacts import PointPairs, nearest_contacts, strictly_rising
from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.model.contacts import joined, select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.errors import StepRejected

SAME_PLACE = 4.0
"""Largest distance of a contact's points from those carried along, over the way, at which it is the same contact."""


class TrackedPairs:
    """Contacts of the same pairs in the same order at any pose, by a detector that needs no mesh; the pairs are those
    within ``reach`` [length] at ``pose``.

    A contact of a pair that has several is the one found nearest to its points as the bodies carry them along. A
    contact that is not found there any more goes on at the points carried along, so that its force ends with the step
    and not within it.
    """

    def __init__(self, system: System, pose: Pose, reach: float) -> None:
        self._system, self._pose, self._reach = system, pose, reach
        self.start = self._detected(pose, reach)
        self._pairs = self._numbers(self.start)

    def extrapolate(self, pose: Pose) -> Contacts:
        """Contacts of the pairs when the bodies are at ``pose``; raises StepRejected if another pair is in range."""
        moved = float(travel(self._system, self._pose, pose).max())
        found = self._detected(pose, (self._reach + 2.0 * moved) * (1.0 + 1e-9))
        numbers = self._numbers(found)
        if np.array_equal(numbers, self._pairs) and strictly_rising(numbers):
            return found
        self._refuse_others(found, np.isin(numbers // 2, self._pairs // 2, invert=True))
        if strictly_rising(self._pairs) and strictly_rising(numbers):
            return select(found, np.searchsorted(numbers, self._pairs))
        expected = ExtrapolatedContacts(self.start, self._pose).extrapolate(pose)
        return self._matched(found, numbers, expected, SAME_PLACE * moved)

    def missed(self, law: ForceLaw, pose: Pose) -> float:
        """Energy of the contacts at ``pose`` less that of those tracked there: that of contacts that came, or went,
        untracked."""
        if strictly_rising(self._pairs) and not self._system.arms.any():
            return 0.0  # two balls have one contact, and others are refused
        return float(law.energy(self._detected(pose, law.range)).sum() - law.energy(self.extrapolate(pose)).sum())

    def _matched(self, found: Contacts, numbers: IntArray, carried: Contacts, far: float) -> Contacts:
        """Contacts ``found`` at the places of those ``carried`` along, one for each; the carried one where none is as
        near as ``far``."""
        both, row = joined([found, carried]), np.arange(len(carried)) + len(found)
        for pair in np.unique(self._pairs):
            there, here = np.flatnonzero(numbers == pair), np.flatnonzero(self._pairs == pair)
            mine, theirs, away = nearest_contacts(_points(carried, here), _points(found, there))
            near = away <= far
            row[here[mine[near]]] = there[theirs[near]]
        return select(both, row)

    def _detected(self, pose: Pose, reach: float) -> Contacts:
        return interacting(self._system, detect(self._system, pose, None, reach))

    def _numbers(self, contacts: Contacts) -> IntArray:
        """Number of each contact's pair, image and sign, in the detectors' order of pairs."""
        images, count = image_codes(contacts, self._system.lattice)
        pairs = contacts.body_a * len(self._system.surfaces) + contacts.body_b
        return 2 * (count * pairs + images) + (contacts.sign > 0.0)

    def _refuse_others(self, found: Contacts, others: np.ndarray) -> None:
        entered = np.flatnonzero(others & (found.gap < self._system.law_range))
        if len(entered):
            names = [self._system.surfaces[body[entered[0]]] for body in (found.body_a, found.body_b)]
            raise StepRejected(
                f"body {names[0]}",
                f"a contact with {names[1]} that was not foreseen at the start of the step",
                "contacts between surfaces that may meet at four times the fastest speed",
                "Shorten the step.",
            )


def _points(contacts: Contacts, rows: IntArray) -> PointPairs:
    return PointPairs(contacts.point_a[rows], contacts.point_b[rows])
