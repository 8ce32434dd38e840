"""Broad phase: pairs of bodies and body–wall pairs whose bounding balls are near each other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.wall import Wall

SKIN = 0.6
"""Distance beyond the reach up to which lists that are kept for some time are made, over the mean radius."""

_FEW = 32
"""Number of balls up to which all pairs are looked at; a tree takes longer to load than a run of so few to start."""


def near_pairs(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """Pairs a < b of balls with |x_a - x_b| - r_a - r_b ≤ ``reach``, from all pairs or a search tree: numbers a and b
    (m,) each, in no particular order; pairs that rounding puts just beyond are among them. ``position`` (n, d),
    ``radii`` (n,) and ``reach``, which may be infinite [length]."""
    first, second = _candidates(position, radii, reach)
    gap = np.linalg.norm(position[first] - position[second], axis=1) - radii[first] - radii[second]
    near = gap <= reach + _rounding(radii, reach)
    return first[near], second[near]


def near_walls(position: FloatArray, radii: FloatArray, walls: Sequence[Wall], reach: float) -> list[tuple[int, Wall]]:
    """Bodies and walls with d(x) - r ≤ ``reach``, d the distance to the wall, sorted by body; pairs that rounding puts
    just beyond are among them. ``position`` (n, d), ``radii`` (n,) and ``reach``, which may be infinite [length]."""
    bodies, rows = rows_of_near_walls(position, radii, walls, reach)
    return [(body, walls[row]) for body, row in zip(bodies.tolist(), rows.tolist(), strict=True)]


def rows_of_near_walls(
    position: FloatArray, radii: FloatArray, walls: Sequence[Wall], reach: float
) -> tuple[IntArray, IntArray]:
    """Bodies and rows of the walls of `near_walls`, (m,) each."""
    near = np.zeros((len(radii), len(walls)), dtype=bool)
    for row, wall in enumerate(walls):
        near[:, row] = wall.shape.signed_distance(position) - radii <= reach + _rounding(radii, reach)
    bodies, rows = near.nonzero()
    return bodies, rows


def least_gaps(position: FloatArray, radii: FloatArray, walls: Sequence[Wall]) -> FloatArray:
    """Lower bound of each ball's nearest gap (n,), min(|x - x'| - r - max r, d(x) - r), x' the nearest neighbour, d the
    distance to walls; it may be negative, and is infinite for a ball alone without walls [length]."""
    least = np.full(len(radii), np.inf)
    if len(radii) > 1:
        least = nearest_others(position)[0] - radii - radii.max()
    for wall in walls:
        least = np.minimum(least, wall.shape.signed_distance(position) - radii)
    return least


def nearest_others(position: FloatArray) -> tuple[FloatArray, IntArray]:
    """Distance (n,) of each point to the nearest other one [length], and which that is (n,); ``position`` (n, d) of two
    or more [length]."""
    if len(position) > _FEW:
        distance, other = (np.asarray(each)[:, 1] for each in scipy.spatial.cKDTree(position).query(position, k=2))
        return distance, other
    distances = np.linalg.norm(position[:, None] - position, axis=2)
    np.fill_diagonal(distances, np.inf)
    return distances.min(axis=1), distances.argmin(axis=1)


def _candidates(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    if len(radii) <= _FEW or not np.isfinite(reach):
        return _all_pairs(len(radii))
    span = max(reach + 2 * float(radii.max()), 0.0)
    tree = scipy.spatial.cKDTree(position, compact_nodes=False, balanced_tree=False)
    pairs = tree.query_pairs(span + _rounding(radii, reach), output_type="ndarray")
    return pairs[:, 0].astype(np.int64), pairs[:, 1].astype(np.int64)


@lru_cache(maxsize=2)
def _all_pairs(count: int) -> tuple[IntArray, IntArray]:
    first, second = np.triu_indices(count, k=1)
    return first.astype(np.int64), second.astype(np.int64)


def _rounding(radii: FloatArray, reach: float) -> float:
    return 1e-12 * (float(radii.max(initial=0.0)) + abs(reach))
