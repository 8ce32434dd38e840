"""Largest root of a secular equation, which gives nearest and farthest points of ellipsoids."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

_MAX_ITERATIONS = 1000


def secular_image(numerator: FloatArray, shift: FloatArray) -> FloatArray:
    """Image p_i = b_i/(s + c_i) (N, d), of length 1 to rounding, at the largest root s of |p(s)| = 1 (D. Eberly,
    "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid", 2013).

    Newton's method is applied to 1/|p| - 1 (Moré and Sorensen 1983, doi:10.1137/0904038), which is concave and
    increasing in s, so that the iterates grow monotonically from a lower bound to the root; FloatingPointError is
    raised if they do not converge. ``numerator`` b ≥ 0 (N, d) is not zero where c is; ``shift`` c ≥ 0 (d,) or (N, d) is
    zero at least once in each row.
    """
    # at this lower bound at least one component of p is 1 or more
    root = np.max(numerator - shift, axis=1, keepdims=True)
    for _ in range(_MAX_ITERATIONS):
        denominator = root + shift
        image: FloatArray = numerator / denominator
        square = np.sum(image**2, axis=1, keepdims=True)
        slope = np.sum(image**2 / denominator, axis=1, keepdims=True)
        newton = square * (np.sqrt(square) - 1) / slope
        if not np.any(newton > 4 * np.finfo(float).eps * root):
            return image
        root = root + np.maximum(newton, 0.0)
    raise FloatingPointError("the root of a secular equation was not found")
