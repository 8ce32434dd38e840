"""Rows of contacts: a choice of them, several parts in one, sorted, their middles and radii, and parts of vectors
there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from operator import attrgetter
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.types import Contacts

_columns = attrgetter(*Contacts.__slots__)


def select(contacts: Contacts, chosen: IntArray | BoolArray) -> Contacts:
    """Contacts in the rows ``chosen``, (k,) numbers in the order wanted or (m,) truth values; the same record where all
    are true."""
    if chosen.dtype.kind == "b" and chosen.all():
        return contacts
    taken: list[Any] = [None if column is None else column[chosen] for column in _columns(contacts)]
    return Contacts(*taken)


def joined(parts: Sequence[Contacts]) -> Contacts:
    """All contacts of at least one part, part by part."""
    columns: Iterator[Any] = ([getattr(part, field) for part in parts] for field in Contacts.__slots__)
    return Contacts(*map(_in_one, columns))


def _in_one(columns: Sequence[Any]) -> Any:
    """One column of several, or None where nothing is given."""
    return None if columns[0] is None else np.concatenate(columns)


def in_order(parts: Sequence[Contacts]) -> Contacts:
    """All contacts of at least one part, sorted by (body_a, body_b)."""
    merged = joined(parts)
    return select(merged, np.lexsort((merged.body_b, merged.body_a)))


def middle(contacts: Contacts) -> FloatArray:
    """Middle between the contact points, (m, d) [length]."""
    return np.asarray(0.5 * (contacts.point_a + contacts.point_b))


def points_of_b(contacts: Contacts) -> FloatArray:
    """Points on b itself and not on the image of it that is met, (m, d) [length]."""
    return contacts.point_b if contacts.shift is None else contacts.point_b - contacts.shift


def sides(contacts: Contacts) -> tuple[tuple[IntArray, FloatArray], tuple[IntArray, FloatArray]]:
    """The number (m,) of a, then of b, and the middle between the contact points as the body itself sees it and not its
    image, (m, d) [length]."""
    both = middle(contacts)
    return (contacts.body_a, both), (contacts.body_b, both if contacts.shift is None else both - contacts.shift)


def normal_part(vectors: FloatArray, contacts: Contacts) -> FloatArray:
    """Components of ``vectors`` (m, d) along the normals, (m,)."""
    return np.asarray(np.sum(vectors * contacts.normal, axis=1))


def tangential_part(vectors: FloatArray, contacts: Contacts) -> FloatArray:
    """Parts of ``vectors`` (m, d) along the surfaces, (m, d)."""
    return np.asarray(vectors - normal_part(vectors, contacts)[:, None] * contacts.normal)


def turning_radius(contacts: Contacts) -> FloatArray:
    """Effective radii, over which springs resist turning, (m, 1), zero where not known [length]."""
    return np.where(np.isnan(contacts.effective_radius), 0.0, contacts.effective_radius)[:, None]
