"""The nearest point of an ellipse or ellipsoid, inside and outside, on the axes and at high aspect ratio."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.secular_equation import secular_image

_SMALLEST = 1e-100


def closest_point(points: FloatArray, semi_axes: FloatArray) -> FloatArray:
    """Nearest points (N, d) of the surface Σ (x_i/a_i)² = 1 to ``points`` y (N, d), ``semi_axes`` a (d,) [length].

    One of them is taken if several are nearest.

    The nearest point is x_i = a_i p_i, p_i = r_i z_i/(s + r_i - 1) with z_i = y_i/a_i, r_i = (a_i/a_min)², where s > 0
    is the largest root of |p(s)| = 1, see `secular_image`.
    """
    shortest = int(np.argmin(semi_axes))
    ratios = (semi_axes / semi_axes[shortest]) ** 2
    scaled = np.abs(points) / semi_axes
    # on the plane across the shortest axis the nearest point may lie off it: a tiny offset finds it as a limit
    scaled[:, shortest] = np.maximum(scaled[:, shortest], _SMALLEST)
    image = secular_image(scaled * ratios, ratios - 1)
    image /= np.linalg.norm(image, axis=1, keepdims=True)
    return np.asarray(np.copysign(semi_axes * image, points))
