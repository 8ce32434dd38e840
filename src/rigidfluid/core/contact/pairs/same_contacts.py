"""Recognises contacts of a pair of surfaces that has several, by their points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray

SLIDING = 0.01
"""Weight of the distance of the farther points, relative to that of the nearer ones."""


class PointPairs(NamedTuple):
    """Points of some contacts on the surfaces a and b, (m, d) each [length]."""

    a: FloatArray
    b: FloatArray


def nearest_contacts(first: PointPairs, second: PointPairs) -> tuple[IntArray, IntArray, FloatArray]:
    """Rows of contacts that belong together, each once, at the least sum of distances, and these (k,) [length]."""
    from scipy.optimize import linear_sum_assignment

    away = distances(first, second)
    mine, theirs = linear_sum_assignment(away)
    return mine, theirs, away[mine, theirs]


def strictly_rising(numbers: IntArray) -> bool:
    """Tell whether each of these numbers (m,) is above the one before it, so that all are different and in order."""
    return bool(np.all(numbers[1:] > numbers[:-1]))


def distances(first: PointPairs, second: PointPairs) -> FloatArray:
    """Distance of the nearer points and a little of that of the others, of each of some contacts to each of others, (m,
    k) [length]: a corner goes with its body, while the point that faces it slides."""
    a, b = (np.linalg.norm(one[:, None] - other[None], axis=2) for one, other in zip(first, second, strict=True))
    return np.asarray(np.minimum(a, b) + SLIDING * np.maximum(a, b))
