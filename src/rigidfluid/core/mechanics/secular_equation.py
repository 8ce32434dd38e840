"""The root of a secular equation, on which nearest and farthest points of ellipsoids depend."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray

_MAX_ITERATIONS = 1000


def secular_image(numerator: FloatArray, shift: FloatArray) -> FloatArray:
    """p_i = b_i/(s + c_i) at the largest root s of |p(s)| = 1.

    Newton's method is applied to 1/|p| - 1, which is concave and increasing in s, so that the iterates grow
    monotonically from a lower bound to the root.

    Parameters
    ----------
    numerator : (N, d) array
        b ≥ 0, not zero where c is.
    shift : (d,) or (N, d) array
        c ≥ 0, zero once at least in each row.

    Returns
    -------
    (N, d) array
        p, of length 1 to rounding.

    Raises
    ------
    FloatingPointError
        If the iteration does not come to rest.

    Notes
    -----
    Secular equation: D. Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid" (2013); the
    reciprocal form: Moré and Sorensen (1983), doi:10.1137/0904038.
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
