"""Leaves out what cannot be near: pairs of bodies and body–wall pairs whose bounding balls are too far apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from rigidfluid.core.types import FloatArray, IntArray, Wall

SKIN = 0.6
"""How far beyond the reach `NearPairs` looks, over the mean radius."""

_LISTS = 2
_ALL_PAIRS = 32


@dataclass(frozen=True, slots=True)
class PairList:
    """Pairs a < b within ``reach`` [length] when the balls were at ``position`` (n, d), sorted by (a, b).

    Those of ball a are ``second[start[a]:start[a + 1]]``.
    """

    start: IntArray
    second: IntArray
    position: FloatArray
    reach: float

    def holds(self, position: FloatArray, reach: float) -> bool:
        """Whether no other pair can have come within ``reach``, since nothing has moved far enough."""
        spare = 0.5 * (self.reach - reach)
        return spare > 0.0 and (np.isinf(spare) or bool(_all_near(position, self.position, spare)))


class NearPairs:
    """Verlet's neighbour list: pairs a little further apart than asked for, kept as long as no other can come near.

    It decides how often pairs are searched for, and never which contacts are found.

    Parameters
    ----------
    radii : (n,) array
        Radii of the balls [length].

    Notes
    -----
    Verlet 1967, DOI 10.1103/PhysRev.159.98.
    """

    def __init__(self, radii: FloatArray) -> None:
        self._radii = radii
        self._skin = SKIN * float(radii.mean()) if len(radii) else 0.0
        self._lists: list[PairList] = []

    def within(self, position: FloatArray, reach: float) -> PairList:
        """All pairs with |x_a - x_b| - r_a - r_b ≤ ``reach`` for balls at ``position`` (n, d), and some more."""
        for found in self._lists:
            # a list that looks much too far would be right, but slow
            if found.reach <= reach + 2.0 * self._skin and found.holds(position, reach):
                return found
        made = self._made(position, reach)
        self._lists = [made, *self._lists[: _LISTS - 1]]
        return made

    def _made(self, position: FloatArray, reach: float) -> PairList:
        count = len(self._radii)
        wide = np.inf if count <= _ALL_PAIRS else reach + self._skin
        first, second = near_pairs(position, self._radii, wide)
        order = np.lexsort((second, first))
        start = np.searchsorted(first[order], np.arange(count + 1))
        return PairList(start, second[order], position.copy(), wide)


def near_pairs(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """Pairs a < b of balls with |x_a - x_b| - r_a - r_b ≤ ``reach``, from all pairs or a search tree.

    Parameters
    ----------
    position : (n, d) array
        Centres [length].
    radii : (n,) array
        Radii [length].
    reach : float
        Largest gap, may be infinite [length].

    Returns
    -------
    (m,) array, (m,) array
        Numbers a and b, in no particular order; pairs that rounding puts just beyond are among them.
    """
    first, second = _candidates(position, radii, reach)
    gap = np.linalg.norm(position[first] - position[second], axis=1) - radii[first] - radii[second]
    near = gap <= reach + _rounding(radii, reach)
    return first[near], second[near]


def near_walls(position: FloatArray, radii: FloatArray, walls: Sequence[Wall], reach: float) -> list[tuple[int, Wall]]:
    """Bodies and walls with (x - x_w)·n - r ≤ ``reach``.

    Parameters
    ----------
    position : (n, d) array
        Centres [length].
    radii : (n,) array
        Radii [length].
    walls : sequence of Wall
        Flat walls.
    reach : float
        Largest gap, may be infinite [length].

    Returns
    -------
    list of (int, Wall)
        Sorted by body; pairs that rounding puts just beyond are among them.
    """
    slack = reach + _rounding(radii, reach)
    near = [(position - wall.point) @ wall.normal - radii <= slack for wall in walls]
    return [(body, wall) for body in range(len(radii)) for wall, close in zip(walls, near, strict=True) if close[body]]


def least_gaps(position: FloatArray, radii: FloatArray, walls: Sequence[Wall]) -> FloatArray:
    """Lower bound of each ball's nearest gap, min(|x - x'| - r - max r, (x - x_w)·n - r) with x' its nearest neighbour.

    Parameters
    ----------
    position : (n, d) array
        Centres [length].
    radii : (n,) array
        Radii [length].
    walls : sequence of Wall
        Flat walls.

    Returns
    -------
    (n,) array
        May be negative, is infinite for a ball alone without walls [length].
    """
    from scipy.spatial import cKDTree

    least = np.full(len(radii), np.inf)
    if len(radii) > 1:
        nearest = np.asarray(cKDTree(position).query(position, k=2)[0])
        least = nearest[:, 1] - radii - radii.max()
    for wall in walls:
        least = np.minimum(least, (position - wall.point) @ wall.normal - radii)
    return least


def _candidates(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    if len(radii) < 2 or not np.isfinite(reach):
        first, second = np.triu_indices(len(radii), k=1)
        return first.astype(np.int64), second.astype(np.int64)
    from scipy.spatial import cKDTree

    span = max(reach + 2 * float(radii.max()), 0.0)
    tree = cKDTree(position, compact_nodes=False, balanced_tree=False)
    pairs = tree.query_pairs(span + _rounding(radii, reach), output_type="ndarray")
    return pairs[:, 0].astype(np.int64), pairs[:, 1].astype(np.int64)


def _rounding(radii: FloatArray, reach: float) -> float:
    return 1e-12 * (float(radii.max(initial=0.0)) + abs(reach))


@njit(cache=True, nogil=True)
def _all_near(position, before, distance):  # type: ignore[no-untyped-def]
    """Whether every point is less than a distance from where it was."""
    for i in range(len(position)):
        square = 0.0
        for k in range(position.shape[1]):
            square += (position[i, k] - before[i, k]) ** 2
        if not square < distance**2:
            return False
    return True
