"""Response of a law along the gap: its largest force, where it holds a weight, how much it stores.

The law itself is evaluated, on contacts made up for the purpose, so that this holds for any law.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs.representative_contacts import contacts_at_gaps
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.types import Contacts

_HALVINGS = 60
_ZOOMS = 3
_FRACTIONS = np.concatenate([np.logspace(-9, -2, 36), np.linspace(0.02, 1.0, 99)])
"""Gaps over the range [1]: dense near contact, for laws that are unbounded there."""


def force_along(law: ForceLaw, contacts: Contacts, gaps: FloatArray) -> FloatArray:
    """Force on a along the normal at the gaps (m, G) of each contact, (m, G) [force]."""
    many = contacts_at_gaps(contacts, gaps)
    return np.asarray(np.sum(law.force(many) * many.normal, axis=1).reshape(gaps.shape))


def energy_along(law: ForceLaw, contacts: Contacts, gaps: FloatArray) -> FloatArray:
    """Energy at the gaps (m, G) of each contact, (m, G) [energy]."""
    return law.energy(contacts_at_gaps(contacts, gaps)).reshape(gaps.shape)


def largest_force(law: ForceLaw, contacts: Contacts) -> tuple[FloatArray, FloatArray]:
    """The largest force of each contact without overlap (m,), infinite where the law is unbounded, and its gap (m,).

    From a grid, whose best interval is divided again three times.
    """
    if law.overlap == "unbounded":
        return np.full(len(contacts), np.inf), np.zeros(len(contacts))
    gaps = _grid(law, contacts)
    for _ in range(_ZOOMS + 1):
        force = force_along(law, contacts, gaps)
        best = np.argmax(force, axis=1)[:, None]
        low = np.take_along_axis(gaps, np.maximum(best - 1, 0), axis=1)
        high = np.take_along_axis(gaps, np.minimum(best + 1, gaps.shape[1] - 1), axis=1)
        there = np.take_along_axis(gaps, best, axis=1)[:, 0]
        gaps = low + np.linspace(0.0, 1.0, 65) * (high - low)
    return np.asarray(force.max(axis=1)), there


def rest_gap(law: ForceLaw, contacts: Contacts, weight: FloatArray, deepest: float) -> FloatArray:
    """The largest gap at which the force holds each ``weight`` (m,) and grows inward, NaN where there is none, (m,).

    A law that repels in overlap is asked there too, down to a gap of -``deepest`` [length].
    """
    gaps = _grid(law, contacts)
    if law.overlap != "unbounded":
        _, strongest = largest_force(law, contacts)
        gaps = np.sort(np.concatenate([gaps, strongest[:, None]], axis=1), axis=1)
    if law.overlap == "repels":
        overlap = np.broadcast_to(-deepest * _FRACTIONS[::-1], (len(contacts), len(_FRACTIONS)))
        gaps = np.concatenate([overlap, gaps], axis=1)
    held = force_along(law, contacts, gaps) >= weight[:, None]
    # the outermost point that holds; beyond it none does, so the root lies just outside
    last = gaps.shape[1] - 1 - np.argmax(held[:, ::-1], axis=1)[:, None]
    low = np.take_along_axis(gaps, last, axis=1)
    high = np.take_along_axis(gaps, np.minimum(last + 1, gaps.shape[1] - 1), axis=1)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        holds = force_along(law, contacts, middle) >= weight[:, None]
        low, high = np.where(holds, middle, low), np.where(holds, high, middle)
    return np.where(held.any(axis=1), low[:, 0], np.nan)


def barrier(law: ForceLaw, contacts: Contacts) -> FloatArray:
    """The energy that a contact stores before overlap (m,), infinite where the law is unbounded [energy]."""
    if law.overlap == "unbounded":
        return np.full(len(contacts), np.inf)
    return np.asarray(energy_along(law, contacts, _grid(law, contacts)).max(axis=1))


def turning_gap(law: ForceLaw, contacts: Contacts, energy: FloatArray, weight: FloatArray) -> FloatArray:
    """Gap at which an approach of kinetic ``energy`` (m,) ends while a ``weight`` (m,) pushes on, (m,) [length].

    It is the gap with U(gap) = energy + weight (range - gap), and next to nothing where the law stops nothing.
    """
    low, high = np.zeros((len(contacts), 1)), np.full((len(contacts), 1), law.range)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        stopped = energy_along(law, contacts, middle) >= energy[:, None] + weight[:, None] * (law.range - middle)
        low, high = np.where(stopped, middle, low), np.where(stopped, high, middle)
    return np.asarray(high[:, 0])


def _grid(law: ForceLaw, contacts: Contacts) -> FloatArray:
    """Gaps (m, G) from contact to range; contact itself only where a law is defined there."""
    fractions = _FRACTIONS if law.overlap == "unbounded" else np.append(0.0, _FRACTIONS)
    return np.tile(law.range * fractions, (len(contacts), 1))
