"""The nearest point of an ellipse or ellipsoid, inside and outside, on the axes and at high aspect ratio."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray

_MAX_ITERATIONS = 1000
_SMALLEST = 1e-100


def closest_point(points: FloatArray, semi_axes: FloatArray) -> FloatArray:
    """Nearest points of the surface Σ (x_i/a_i)² = 1.

    The nearest point is x_i = a_i p_i, p_i = r_i z_i/(s + r_i - 1) with z_i = y_i/a_i, r_i = (a_i/a_min)², where s > 0
    is the largest root of the secular equation |p(s)| = 1. Newton's method is applied to 1/|p| - 1, which is concave
    and increasing in s, so that the iterates grow monotonically from a lower bound to the root.

    Parameters
    ----------
    points : (N, d) array
        Points y in the ellipsoid's frame [length].
    semi_axes : (d,) array
        Semi-axes a [length].

    Returns
    -------
    (N, d) array
        Nearest points of the surface; where several are nearest, one of them [length].

    Raises
    ------
    FloatingPointError
        If the iteration does not come to rest.

    Notes
    -----
    Secular equation: D. Eberly, "Distance from a point to an ellipse, an ellipsoid, or a hyperellipsoid" (2013); the
    reciprocal form: Moré and Sorensen (1983), doi:10.1137/0904038.
    """
    shortest = int(np.argmin(semi_axes))
    ratios = (semi_axes / semi_axes[shortest]) ** 2
    scaled = np.abs(points) / semi_axes
    # on the plane across the shortest axis the nearest point may lie off it: a tiny offset finds it as a limit
    scaled[:, shortest] = np.maximum(scaled[:, shortest], _SMALLEST)
    image = _secular_image(scaled, ratios)
    image /= np.linalg.norm(image, axis=1, keepdims=True)
    return np.asarray(np.copysign(semi_axes * image, points))


def _secular_image(scaled: FloatArray, ratios: FloatArray) -> FloatArray:
    """p at the root, (N, d), for ``scaled`` z (N, d) ≥ 0 and ``ratios`` r (d,) ≥ 1."""
    numerator = scaled * ratios
    shift = ratios - 1
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
    raise FloatingPointError("the closest point of an ellipsoid was not found")
