"""Contacts of one pose, detected anew at others."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.proximity import detect, interacting, travel
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, IntArray, Pose
from rigidfluid.errors import StepRejected


class TrackedPairs:
    """The same pairs in the same order at any pose, by a detector that needs no mesh.

    Parameters
    ----------
    system : System
        Bodies, law, detector.
    pose : Pose
        Where the pairs are looked for.
    reach : float
        Up to which gap [length].
    """

    def __init__(self, system: System, pose: Pose, reach: float) -> None:
        self._system, self._pose, self._reach = system, pose, reach
        self.start = self._detected(pose, reach)
        self._pairs = self._numbers(self.start)

    def at(self, pose: Pose) -> Contacts:
        """The pairs when the bodies are at ``pose``.

        Raises
        ------
        StepRejected
            If another pair is in range there.
        """
        moved = float(travel(self._system, self._pose, pose).max())
        found = self._detected(pose, (self._reach + 2.0 * moved) * (1.0 + 1e-9))
        numbers = self._numbers(found)
        self._refuse_others(found, np.isin(numbers, self._pairs, invert=True))
        return select(found, np.searchsorted(numbers, self._pairs))

    def _detected(self, pose: Pose, reach: float) -> Contacts:
        near = detect(self._system, pose, None, reach)
        return select(near, interacting(self._system, near))

    def _numbers(self, contacts: Contacts) -> IntArray:
        """One for each pair, in the detectors' order."""
        return contacts.body_a * len(self._system.surfaces) + contacts.body_b

    def _refuse_others(self, found: Contacts, others: np.ndarray) -> None:
        law_range = self._system.law.range if self._system.law else 0.0
        met = np.flatnonzero(others & (found.gap < law_range))
        if len(met):
            names = [self._system.surfaces[body[met[0]]] for body in (found.body_a, found.body_b)]
            raise StepRejected(
                f"body {names[0]}",
                f"a contact with {names[1]} that was not foreseen at the start of the step",
                "contacts between surfaces that may meet at four times the fastest speed",
                "Shorten the step.",
            )
