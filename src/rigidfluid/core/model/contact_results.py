"""Refuses contacts of a detector that no run may go on with."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from rigidfluid.core.geometry.answers import refuse_other_rows, refuse_other_shape
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wall import Wall, radius_of
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.model.types import Contacts, Pose

_APART = 1e-6
"""Greatest distance from ``point_b + gap * normal`` to ``point_a``, over the gap."""

_ROUNDING = 1e-9
"""Greatest error of the length of normals, and of that distance over the coordinates of points and of the body."""

_FEW = 4
"""Number of contacts for which no compiler is loaded, in a process that has not loaded it for others."""

_KINDS = {
    "body_a": "iu",
    "body_b": "iu",
    "gap": "fiu",
    "radius_a": "fiu",
    "radius_b": "fiu",
    "at_wall": "b",
    "sign": "fiu",
}
_VECTORS = ("point_a", "point_b", "normal")


def refuse_odd(contacts: Contacts, pose: Pose, bodies: Sequence[Surface], walls: Sequence[Wall]) -> None:
    """Raise `Wrong` unless a detector's contacts are finite, sorted, each there once, between ``bodies`` at a ``pose``
    and ``walls`` that there are, and with points a gap apart along a normal."""
    count = np.shape(contacts.gap)[:1] or (1,)
    for name, kinds in _KINDS.items():
        refuse_other_shape(getattr(contacts, name), count, name, kinds)
    for name in _VECTORS:
        refuse_other_shape(getattr(contacts, name), (*count, pose.position.shape[1]), name)
    if count[0] == 0:
        return
    there = np.zeros(max((len(bodies) - 1, *(wall.surface for wall in walls))) + 1, dtype=np.bool_)
    there[: len(bodies)] = there[[wall.surface for wall in walls]] = True
    a, b, vectors = contacts.body_a, contacts.body_b, (contacts.point_a, contacts.point_b, contacts.normal)
    search: Callable[..., tuple[int, int]] = _first_odd if _are_few(contacts) else _compiled()
    lost, row = _TWICE, -1
    with np.errstate(all="ignore"):  # as in compiled code
        while lost == _TWICE:
            lost, row = search(a, b, contacts.at_wall, there, pose.position, contacts.gap, *vectors, row + 1)
            if lost == _TWICE and not _may_be_corners(a[row], b[row], bodies, walls):
                break
    if lost == 0:
        return
    if lost == _NOT_FINITE:
        for name in ("gap", *_VECTORS):
            refuse_other_rows(getattr(contacts, name), np.shape(getattr(contacts, name)), name, shorter=True)
    found, allowed = _ODD[lost]
    raise Wrong(f"{found}, contact {row} of surfaces {a[row]} and {b[row]}", allowed)


def _are_few(contacts: Contacts) -> bool:
    return len(contacts) <= _FEW and "numba" not in sys.modules


def _may_be_corners(a: int, b: int, bodies: Sequence[Surface], walls: Sequence[Wall]) -> bool:
    """Tell whether both surfaces have corners, or one has and the other is a bump: two that face each other are one
    contact for each, as they are a little beside each other."""
    if b < len(bodies):
        return _has_corners(bodies[a]) and _has_corners(bodies[b])
    wall = next(wall.shape for wall in walls if wall.surface == b)
    return _has_corners(bodies[a]) and (_has_corners(wall) or 0.0 < radius_of(wall) < np.inf)


def _has_corners(shape: Surface) -> bool:
    return getattr(shape, "facets", None) is not None


_NOT_THERE, _NOT_FINITE, _NOT_SORTED, _TWICE, _NOT_APART = range(1, 6)
_ODD = {
    _NOT_FINITE: ("a contact that is too far away", "coordinates whose squares are finite"),
    _NOT_THERE: ("a contact of surfaces that there are not", "body_a a body, body_b a body or wall, as at_wall says"),
    _NOT_SORTED: ("a contact out of order", "contacts sorted by (body_a, body_b), body_a < body_b"),
    _TWICE: ("the contact before it once more", "each contact once"),
    _NOT_APART: ("points that are not a gap apart", "point_a = point_b + gap * normal, with normals of length 1"),
}


@cache
def _compiled() -> Callable[..., Any]:
    from numba import njit

    return njit(cache=True)(_first_odd)


def _first_odd(a, b, at_wall, there, centres, gap, point_a, point_b, normal, first):
    """Kind of the first odd row from the ``first`` on, 0 if there is none, and its number: in one loop, as every
    substep asks."""
    bodies, dimension = centres.shape
    for i in range(first, len(a)):
        if not (0 <= a[i] < bodies and 0 <= b[i] < len(there)) or not there[b[i]] or at_wall[i] != (b[i] >= bodies):
            return _NOT_THERE, i
        length, off, size, same = 0.0, 0.0, 0.0, i > 0
        for k in range(dimension):
            length += normal[i, k] ** 2
            off += (point_b[i, k] + gap[i] * normal[i, k] - point_a[i, k]) ** 2
            size += point_a[i, k] ** 2 + point_b[i, k] ** 2 + centres[a[i], k] ** 2
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
