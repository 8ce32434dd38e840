"""Points spread over the unit circle and the unit sphere."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


def unit_sphere_points(count: int, dimension: int) -> FloatArray:
    """Evenly spread unit vectors (count, dimension): equal angles in 2D, the golden-angle spiral in 3D [1]."""
    index = np.arange(float(count))
    if dimension == 2:
        angle = index * 2 * pi / count
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    height = 1 - (2 * index + 1) / count
    ring = np.sqrt(1 - height**2)
    angle = index * pi * (3 - sqrt(5))
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), height], axis=1)
