"""Stiffness of a law on the way into a contact, for the run and for the check alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts

SAMPLES = 8
"""Number of gaps from the deepest one outward at which a law is sampled."""

MOST_AT_ONCE = 2_000
"""Largest number of contacts, at several gaps each, that a law is asked about in one call: few are asked about at all
gaps at once, as a call costs more than they do."""


def contacts_on_the_way(law: ForceLaw, contacts: Contacts, deepest: FloatArray) -> Iterator[Contacts]:
    """Contacts at SAMPLES gaps from the ``deepest`` (m,) on, in equal steps toward each range, gap by gap [length]; at
    as many gaps in one record as MOST_AT_ONCE allows."""
    parts = np.linspace(0.0, 1.0, SAMPLES, endpoint=False)
    gaps = [deepest + part * np.maximum(begin - deepest, 0.0) for begin in law.ranges for part in parts]
    count = max(MOST_AT_ONCE // max(len(contacts), 1), 1)
    for first in range(0, len(gaps), count):
        some = gaps[first : first + count]
        yield replace(repeated(contacts, len(some)), gap=np.concatenate(some))


def repeated(contacts: Contacts, times: int) -> Contacts:
    """Contacts so many ``times``, one after another."""
    return select(contacts, np.tile(np.arange(len(contacts)), times))


def greatest_of_each(values: FloatArray, count: int) -> FloatArray:
    """Greatest of the ``values`` (m,) of each of ``count`` contacts that were repeated, (count,)."""
    return np.asarray(values.reshape(len(values) // max(count, 1), count).max(axis=0, initial=-np.inf))


def greatest_stiffness(law: ForceLaw, contacts: Contacts, deepest: FloatArray) -> FloatArray:
    """Greatest stiffness of each contact (m,) between its ``deepest`` gap (m,) [length] and the range, at least zero
    [force/length]. Negative ones of a law that attracts count too: the gap then closes ever faster, at that rate."""
    stiffness = np.zeros(len(contacts))
    for there in contacts_on_the_way(law, contacts, deepest):
        found = law.stiffness(there)
        found = found if law.sign == "repels" else np.abs(found)
        stiffness = np.maximum(stiffness, greatest_of_each(found, len(contacts)))
    return stiffness
