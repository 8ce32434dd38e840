"""Verlet's neighbour list: balls that are near each other and flat walls, searched for only now and then."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from rigidfluid.core.contact.pairs.broad_phase import SKIN
from rigidfluid.core.contact.pairs.cell_list import near_each_ball
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.body import Body

_LISTS = 2
_ALL_PAIRS = 32


@dataclass(frozen=True, slots=True)
class PairList:
    """Pairs a < b within ``reach`` [length] when the n balls were at ``position`` (n, d), sorted by (a, b).

    Slice ``second[start[a]:start[a + 1]]`` has the partners of ball a: other balls, then flat walls, numbered from n.
    """

    start: IntArray
    second: IntArray
    position: FloatArray
    reach: float

    def holds(self, position: FloatArray, reach: float) -> bool:
        """Tell whether no other pair can be within ``reach``: all pairs are in the list, or nothing has moved far."""
        if np.isinf(self.reach):
            return True
        spare = self.spare(reach)
        return spare > 0.0 and bool(_all_near(position, self.position, spare))

    def spare(self, reach: float) -> float:
        """Way that any ball may go before another pair can be within ``reach`` [length]."""
        return 0.5 * max(self.reach - reach, 0.0)


class NearPairs:
    """Verlet's neighbour list: pairs a little further apart than asked for, kept as long as no other can come near
    (Verlet 1967, DOI 10.1103/PhysRev.159.98); ``radii`` (n,) [length], and a point and the unit normal of each of the
    flat walls, ``planes`` (w, 2, d).

    The list decides how often pairs are searched for, and never which contacts are found.
    """

    def __init__(self, radii: FloatArray, planes: FloatArray) -> None:
        self.radii, self.planes = radii, planes
        self._skin = SKIN * float(radii.mean()) if len(radii) else 0.0
        self._lists: list[PairList] = []

    def within(self, position: FloatArray, reach: float) -> PairList:
        """Pairs with a gap ≤ ``reach`` for balls at ``position`` (n, d), and some more."""
        wide = self.wider(reach)
        for found in self._lists:
            # a list that looks much too far would be right, but slow
            if found.reach <= wide + self._skin and found.holds(position, reach):
                return found
        start, second = near_each_ball(position, self.radii, self.planes, wide)
        made = PairList(start, second, position.copy(), wide)
        self.keep(made)
        return made

    def wider(self, reach: float) -> float:
        """Reach of a list that is made for this one [length]: infinite for few balls."""
        return np.inf if len(self.radii) <= _ALL_PAIRS else reach + self._skin

    def keep(self, made: PairList) -> None:
        """Keep a list for the next question."""
        self._lists = [made, *self._lists[: _LISTS - 1]]


def flat_walls(bodies: Sequence[Body], walls: Sequence[Wall]) -> FloatArray:
    """A point and the unit normal of each flat wall around ``bodies``, (w, 2, d)."""
    planes = [plane for wall in walls if (plane := wall.shape.plane)]
    rows = [[plane.point, plane.unit_normal] for plane in planes]
    return np.array(rows, dtype=float).reshape(
        len(rows), 2, bodies[0].dimension if bodies else len(planes and planes[0].point)
    )


@njit(cache=True, nogil=True)
def _all_near(position, before, distance):  # type: ignore[no-untyped-def]
    """Tell whether every point is less than a distance from where it was."""
    for i in range(len(position)):
        square = 0.0
        for k in range(position.shape[1]):
            square += (position[i, k] - before[i, k]) ** 2
        if not square < distance**2:
            return False
    return True
