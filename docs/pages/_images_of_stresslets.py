"""Flow that walls and periodic images give at a body in a sheared cell, to the first order in its share."""

from __future__ import annotations

import numpy as np
from scipy.special import zeta

MODES = 60
"""Waves along each period, either way; they decay as exp(-2πnH/L)."""


def image_strain(dimension: int, period: float, distance: float) -> float:
    """Strain rate e_xy at a stresslet S_xy in the middle of a cell, over S_xy/(μV): by two walls at a ``distance``,
    across y, that take its flow away, and by its images at each ``period`` along them.

    The images in the plane give lattice sums. What the walls add is for each wave the flow in a strip that cancels
    that of the plane of stresslets: of waves along the shear in the plane of the shear, of waves across it along the
    walls. The wave of length zero, a jump of the mean velocity in that plane, gives 1/2.
    """
    along, half = distance / period, np.pi / period * distance
    if dimension == 2:
        plane, waves = -np.pi / 6.0 * along, np.arange(1.0, MODES + 1.0)
        return 0.5 + plane + 2.0 * float(_in_plane(half * waves).sum())
    inverse_cubes = 4.0 * zeta(1.5) * (zeta(1.5, 0.25) - zeta(1.5, 0.75)) / 8.0
    one = np.arange(-MODES, MODES + 1.0)
    x, z = (wave.ravel() for wave in np.meshgrid(one, one))
    some = (x != 0.0) | (z != 0.0)
    number = np.hypot(x, z)[some]
    share, depth = (x[some] / number) ** 2, half * number
    walls = share * _in_plane(depth) + (1.0 - share) * _along_walls(depth)
    return 0.5 - 3.0 / (16.0 * np.pi) * inverse_cubes * along + float(walls.sum())


def _in_plane(depth: np.ndarray) -> np.ndarray:
    """Strain by the walls for waves of number q, ``depth`` qH/2, along the shear: the stream function C |y| exp(-q|y|)
    and what cancels it and its slope at the walls, A cosh qy + B y sinh qy, all over exp(qH/2)."""
    twice = np.exp(-2.0 * depth)
    cosh, sinh = 0.5 * (1.0 + twice), 0.5 * (1.0 - twice)
    value, slope = depth * twice, (1.0 - depth) * twice
    determinant = cosh * (sinh + depth * cosh) - depth * sinh**2
    a = value * (sinh + depth * cosh) - depth * sinh * slope
    b = cosh * slope - sinh * value
    return np.asarray(depth * (a + b) / determinant)


def _along_walls(depth: np.ndarray) -> np.ndarray:
    """Strain by the walls for waves across the shear: sgn(y) exp(-q|y|) and what cancels it there, sinh qy."""
    return np.asarray(depth / np.expm1(2.0 * depth))
