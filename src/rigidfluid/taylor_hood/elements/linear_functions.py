"""Linear functions on cells."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


def gradients(corners: FloatArray) -> FloatArray:
    """Gradients (M, d+1, d) of the functions that are 1 at one of the ``corners`` (M, d+1, d) of a cell and 0 at the
    others [1/length]; each is 1 over a height of the cell."""
    slopes = np.linalg.inv(np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 2))
    return np.concatenate([-slopes.sum(axis=1, keepdims=True), slopes], axis=1)
