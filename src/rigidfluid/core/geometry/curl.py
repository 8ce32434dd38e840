"""The curl of a vector field from its slopes."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

_PAIRS = {2: ((1, 0),), 3: ((2, 1), (0, 2), (1, 0))}


def curl(slopes: FloatArray) -> FloatArray:
    """Curl ∇ × u (..., k), in 2D its one component, of slopes ∂u_i/∂x_j (..., d, d)."""
    return np.stack([slopes[..., i, j] - slopes[..., j, i] for i, j in _PAIRS[slopes.shape[-1]]], axis=-1)
