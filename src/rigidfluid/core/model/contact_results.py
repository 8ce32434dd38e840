"""Refuses contacts of a detector that no run may go on with."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from rigidfluid.core.geometry.answers import refuse_other_rows, refuse_other_shape
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.types import Contacts

_APART = 1e-6
"""Greatest distance from ``point_b + gap * normal`` to ``point_a``, over the gap."""

_ROUNDING = 1e-9
"""Greatest error of the length of normals, and of that distance over the coordinates."""

_KINDS = {"body_a": "iu", "body_b": "iu", "gap": "fiu", "radius_a": "fiu", "radius_b": "fiu", "at_wall": "b"}
_VECTORS = ("point_a", "point_b", "normal")


def refuse_odd(contacts: Contacts, dimension: int, bodies: int, walls: Sequence[int]) -> None:
    """Raise `Wrong` unless a detector's contacts are finite, sorted, each there once, between ``bodies`` and ``walls``
    that there are, and with points a gap apart along a normal."""
    count = np.shape(contacts.gap)[:1] or (1,)
    for name, kinds in _KINDS.items():
        refuse_other_shape(getattr(contacts, name), count, name, kinds)
    for name in _VECTORS:
        refuse_other_shape(getattr(contacts, name), (*count, dimension), name)
    if count[0] == 0:
        return
    there = np.zeros(max((bodies - 1, *walls)) + 1, dtype=np.bool_)
    there[:bodies] = there[list(walls)] = True
    a, b, vectors = contacts.body_a, contacts.body_b, (contacts.point_a, contacts.point_b, contacts.normal)
    lost, row = _first_odd(a, b, contacts.at_wall, there, bodies, contacts.gap, *vectors)
    if lost == 0:
        return
    if lost == _NOT_FINITE:
        for name in ("gap", *_VECTORS):
            refuse_other_rows(getattr(contacts, name), np.shape(getattr(contacts, name)), name, shorter=True)
    found, allowed = _ODD[lost]
    raise Wrong(f"{found}, contact {row} of surfaces {a[row]} and {b[row]}", allowed)


_NOT_THERE, _NOT_FINITE, _NOT_SORTED, _TWICE, _NOT_APART = range(1, 6)
_ODD = {
    _NOT_THERE: ("a contact of surfaces that there are not", "body_a a body, body_b a body or wall, as at_wall says"),
    _NOT_SORTED: ("a contact out of order", "contacts sorted by (body_a, body_b), body_a < body_b"),
    _TWICE: ("the contact before it once more", "each contact once"),
    _NOT_APART: ("points that are not a gap apart", "point_a = point_b + gap * normal, with normals of length 1"),
}


@njit(cache=True)
def _first_odd(a, b, at_wall, there, bodies, gap, point_a, point_b, normal):
    """Kind of the first odd row, 0 if there is none, and its number: in one loop, as every substep asks."""
    dimension = normal.shape[1]
    for i in range(len(a)):
        if not (0 <= a[i] < bodies and 0 <= b[i] < len(there)) or not there[b[i]] or at_wall[i] != (b[i] >= bodies):
            return _NOT_THERE, i
        length, off, size, same = 0.0, 0.0, 0.0, i > 0
        for k in range(dimension):
            length += normal[i, k] ** 2
            off += (point_b[i, k] + gap[i] * normal[i, k] - point_a[i, k]) ** 2
            size += point_a[i, k] ** 2 + point_b[i, k] ** 2
            same = same and point_a[i, k] == point_a[i - 1, k] and point_b[i, k] == point_b[i - 1, k]
        if not np.isfinite(length + off + size):
            return _NOT_FINITE, i
        if abs(length - 1.0) > _ROUNDING or np.sqrt(off) > _APART * abs(gap[i]) + _ROUNDING * np.sqrt(size):
            return _NOT_APART, i
        if a[i] >= b[i] or (i > 0 and (a[i] < a[i - 1] or (a[i] == a[i - 1] and b[i] < b[i - 1]))):
            return _NOT_SORTED, i
        if same and a[i] == a[i - 1] and b[i] == b[i - 1]:
            return _TWICE, i
    return 0, 0
