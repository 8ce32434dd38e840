"""Refuses contacts of a detector that no run may go on with."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit

from rigidfluid.core.model.part_results import refuse_no_number, refuse_shape, remedy
from rigidfluid.core.model.types import Contacts
from rigidfluid.errors import PluginError


def refuse_lost_contacts(contacts: Contacts, bodies: int, surfaces: int, dimension: int) -> None:
    """Raise an error unless a detector's contacts are finite, and between surfaces that there are."""
    key, count, vectors = "contact.detector", len(contacts), ("point_a", "point_b", "normal")
    for name in vectors:
        refuse_shape(key, name, getattr(contacts, name), (count, dimension), "contact")
    for name in ("body_a", "body_b", "gap", "at_wall"):
        refuse_shape(key, name, getattr(contacts, name), (count,), "contact")
    if not _exist(contacts.body_a, contacts.body_b, contacts.at_wall, bodies, surfaces):
        found = "a contact of surfaces that there are not"
        allowed = f"body_a from 0 to {bodies - 1}, body_b from 0 to {surfaces - 1}, at_wall from {bodies} on"
        raise PluginError(key, found, allowed, remedy(key))
    if not _finite(contacts.gap, contacts.point_a, contacts.point_b, contacts.normal):
        for name in ("gap", *vectors):
            refuse_no_number("contacts", name, getattr(contacts, name), key)


@njit(cache=True)
def _exist(body_a, body_b, at_wall, bodies, surfaces):
    missing = 0
    for i in range(len(body_a)):
        there_are = 0 <= body_a[i] < bodies and 0 <= body_b[i] < surfaces
        missing += not (there_are and at_wall[i] == (body_b[i] >= bodies))
    return missing == 0


@njit(cache=True)
def _finite(gap, *vectors):
    """Whether all numbers are finite, in one loop, as a detector is asked in every substep."""
    lost = 0
    for i in range(len(gap)):
        lost += not np.isfinite(gap[i])
        for vector in vectors:
            for k in range(vector.shape[1]):
                lost += not np.isfinite(vector[i, k])
    return lost == 0
