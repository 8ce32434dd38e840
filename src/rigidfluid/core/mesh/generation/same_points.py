"""Finds points again that a mesher has given back in another order, changed by rounding."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray

_ALONG = np.sqrt([2.0, 3.0, 5.0])
"""A direction in which no two points of a lattice have the same height. To sort by it costs .1 s of CPU less than to
load SciPy's trees."""


def rows_of(wanted: FloatArray, points: FloatArray, within: float) -> IntArray | None:
    """Rows (m,) of ``points`` (n, d) that are at the ``wanted`` ones (m, d), to a distance ``within`` [length]; None
    unless each has one of its own."""
    along = _ALONG[: points.shape[1]]
    height, level = points @ along, wanted @ along
    order, slack = np.argsort(height), within * float(np.linalg.norm(along))
    first = np.searchsorted(height[order], level - slack)
    count = np.searchsorted(height[order], level + slack, side="right") - first
    one = np.repeat(np.arange(len(wanted)), count)
    row = order[np.arange(len(one)) + np.repeat(first - (np.cumsum(count) - count), count)]
    apart = np.linalg.norm(points[row] - wanted[one], axis=1)
    nearest = np.lexsort((apart, one))
    found, first = np.unique(one[nearest], return_index=True)
    row, apart = row[nearest[first]], apart[nearest[first]]
    is_found = len(found) == len(wanted) and np.all(apart <= within) and len(np.unique(row)) == len(row)
    return np.asarray(row) if is_found else None
