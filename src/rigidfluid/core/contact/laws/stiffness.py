"""Stiffness of a law on the way into a contact, for the run and for the check alike."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts

SAMPLES = 8
"""Number of gaps from the deepest one outward at which a law is sampled."""


def contacts_on_the_way(law: ForceLaw, contacts: Contacts, deepest: FloatArray) -> Iterator[Contacts]:
    """Contacts at SAMPLES gaps from the ``deepest`` (m,) on, in equal steps toward each range [length]."""
    for begin in law.ranges:
        for part in np.linspace(0.0, 1.0, SAMPLES, endpoint=False):
            yield replace(contacts, gap=deepest + part * np.maximum(begin - deepest, 0.0))


def greatest_stiffness(law: ForceLaw, contacts: Contacts, deepest: FloatArray) -> FloatArray:
    """Greatest stiffness of each contact (m,) between its ``deepest`` gap (m,) [length] and the range, at least zero
    [force/length]. Negative ones of a law that attracts count too: the gap then closes ever faster, at that rate."""
    stiffness = np.zeros(len(contacts))
    for there in contacts_on_the_way(law, contacts, deepest):
        found = law.stiffness(there)
        stiffness = np.maximum(stiffness, found if law.sign == "repels" else np.abs(found))
    return stiffness
