"""Pairs of bodies whose bounding balls are near each other."""

from __future__ import annotations

import numpy as np

from rigidfluid.api import FloatArray, IntArray

_MARGIN = 1e-12


def near_pairs(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    """Pairs a < b with |x_a - x_b| - r_a - r_b ≤ reach.

    Parameters
    ----------
    position : (n, d) array
        Centres of the balls [length].
    radii : (n,) array
        Their radii [length].
    reach : float
        Largest distance; may be infinite [length].

    Returns
    -------
    tuple of two (m,) arrays
        Numbers a and b; a few pairs more than asked for, so that rounding loses none.
    """
    first, second = _candidates(position, radii, reach)
    apart = np.linalg.norm(position[first] - position[second], axis=1)
    span = radii[first] + radii[second]
    near = apart - span <= reach + _MARGIN * (apart + span)
    return first[near], second[near]


def _candidates(position: FloatArray, radii: FloatArray, reach: float) -> tuple[IntArray, IntArray]:
    if len(radii) < 2 or not np.isfinite(reach):
        first, second = np.triu_indices(len(radii), k=1)
        return first.astype(np.int64), second.astype(np.int64)
    from scipy.spatial import cKDTree

    span = max(reach + 2 * float(radii.max()), 0.0)
    pairs = cKDTree(position).query_pairs(span * (1 + _MARGIN), output_type="ndarray")
    return pairs[:, 0].astype(np.int64), pairs[:, 1].astype(np.int64)
