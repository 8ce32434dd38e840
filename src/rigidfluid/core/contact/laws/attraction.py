"""Energy that laws which attract can release."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts

_FRACTIONS = np.concatenate([np.logspace(-6, -1, 21), np.linspace(0.15, 0.95, 17)])
"""Gaps over the range [1] among which the least energy is looked for: dense near contact, where attraction is
strongest."""


def releasable_energy(law: ForceLaw, contacts: Contacts) -> FloatArray:
    """Energy U(gap) - min U that each contact can give to its bodies, (m,): all of it where a law only repels
    [energy]."""
    energy = law.energy(contacts)
    return energy if law.sign == "repels" else np.maximum(energy + greatest_attraction(law, contacts), 0.0)


def greatest_attraction(law: ForceLaw, contacts: Contacts) -> FloatArray:
    """Depth -min U of a law's energy below that at range, (m,), zero where it only repels [energy]."""
    deepest = np.zeros(len(contacts))
    if law.sign != "repels":
        for fraction in _FRACTIONS:
            near = replace(contacts, gap=np.full(len(contacts), fraction * law.range))
            deepest = np.maximum(deepest, -law.energy(near))
    return deepest
