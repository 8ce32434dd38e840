"""Loads that add up in stacks and heaps: what the bodies above a body put on it, besides its own."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs
from rigidfluid.core.geometry.arrays import FloatArray, IntArray


def stack_loads(
    own: FloatArray, weight: FloatArray, position: FloatArray, radius: FloatArray, box: FloatArray
) -> FloatArray:
    """Loads (n, c) of each body together with those of the bodies that may come to press on it; ``own`` without weight.

    A body presses its ``own`` loads (n, c) in the direction of its submerged ``weight`` (n, d) [force], all weights
    being along one line: heavy bodies downward, buoyant ones upward. It presses on those that start ahead of it: with
    all of its load where the two bounding balls overlap, seen along the weight, and else with 1/N of it, where N of the
    largest bodies fit side by side into the ``box`` of these sides (d,). The larger of the loads from above and from
    below counts. In a heap of equal disks the bodies that overlap one of them are two columns, so that it gets twice
    the mean load.
    """
    if not weight.any():
        return own
    heaviest = weight[np.argmax(np.linalg.norm(weight, axis=1))]
    direction = heaviest / np.linalg.norm(heaviest)
    pairs, share = _overlapping(direction, position, radius), 1.0 / _side_by_side(direction, radius, box)
    pressing = []
    for ahead in (direction, -direction):
        pressed = np.where((weight @ ahead > 0.0)[:, None], own, 0.0)
        depth = position @ ahead
        column = _sum_behind_in_pairs(pressed, depth, pairs)
        pressing.append(column + share * (_sum_behind(pressed, depth) - column))
    return own + np.maximum(*pressing)


def _overlapping(direction: FloatArray, position: FloatArray, radius: FloatArray) -> IntArray:
    """The p pairs of bodies that overlap, seen along ``direction`` (d,), (p, 2)."""
    shadow = position - np.outer(position @ direction, direction)
    pairs = np.column_stack(near_pairs(shadow, radius, 0.0))
    distance = np.linalg.norm(shadow[pairs[:, 0]] - shadow[pairs[:, 1]], axis=1)
    return np.asarray(pairs[distance < radius[pairs].sum(axis=1)])


def _side_by_side(direction: FloatArray, radius: FloatArray, box: FloatArray) -> float:
    """Number of the largest bodies that fit side by side across ``direction`` (d,), at least one."""
    across = np.prod(box) * np.sum(np.abs(direction) / box)
    return max(float(across // (2.0 * radius.max()) ** (len(box) - 1)), 1.0)


def _sum_behind_in_pairs(load: FloatArray, depth: FloatArray, pairs: IntArray) -> FloatArray:
    """Sum, for each body, of the loads (n, c) of its partners in ``pairs`` (p, 2) at a smaller ``depth`` (n,)."""
    total = np.zeros_like(load)
    for behind, ahead in (pairs.T, pairs.T[::-1]):
        pressing = depth[behind] < depth[ahead]
        np.add.at(total, ahead[pressing], load[behind[pressing]])
    return total


def _sum_behind(load: FloatArray, depth: FloatArray) -> FloatArray:
    """Sum, for each body, of the loads (n, c) of all bodies at a smaller ``depth`` (n,)."""
    order = np.argsort(depth)
    sums = np.vstack([np.zeros_like(load[:1]), np.cumsum(load[order], axis=0)])
    return np.asarray(sums[np.searchsorted(depth[order], depth, side="left")])
