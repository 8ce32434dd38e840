"""Drag on a sphere in slow flow of fluids whose viscosity varies, by the least work of axisymmetric flows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss
from scipy.interpolate import BSpline

from rigidfluid.core.geometry.arrays import FloatArray

FAR = 6.5
"""Logarithm of the radius, over that of the sphere, beyond which the fluid is at rest [1]."""
PIECES, DEGREE, POINTS, ANGLES, CHANGE = 40, 5, 5, 16, 1e-6


def drag_on_sphere(viscosity: Callable[[FloatArray], FloatArray], speed: float = 1.0, modes: int = 3) -> float:
    """Drag over 3πdv of a sphere with the diameter d = 1 and the ``speed`` v, of the viscosity over the shear rate.

    R. Hill and G. Power, Q. J. Mech. Appl. Math. 9 (1956) 313, doi:10.1093/qjmam/9.3.313: of all velocities that fit
    the boundary the flow has the least ∫∫ τ dγ̇ dV. Its stream function is a sum of splines of ln r times
    (1 - μ²) P_k'(μ), with μ = cos θ and so many ``modes`` k = 1, 3, …; it is found by linear solutions, each with the
    viscosity of the one before, until the drag changes by less than `CHANGE` of itself.
    """
    rates, given, weights = _strain_rates(modes)
    viscous, drag, before = np.ones(len(weights)), 1.0, 0.0
    while abs(drag - before) > CHANGE * drag:
        scale = np.sqrt(weights * viscous)[:, None]
        scaled = (scale[..., None] * rates).reshape(-1, rates.shape[2])
        found = given - rates @ np.linalg.lstsq(scaled, (scale * given).ravel(), rcond=None)[0]
        rate = np.sqrt(np.sum(found**2, axis=1))
        viscous, before = viscosity(2.0 * speed * rate), drag
        drag = float(np.sum(weights * viscous * rate**2)) / (6.0 * np.pi)
    return drag


def _strain_rates(modes: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Strain rates (points, 4, splines) of free splines, of the sphere's own velocity (points, 4), and volumes."""
    edges = np.linspace(0.0, FAR, PIECES + 1)
    knots = np.r_[[0.0] * DEGREE, edges, [FAR] * DEGREE]
    along, along_weight = leggauss(POINTS)
    around, around_weight = leggauss(ANGLES)
    logarithm = (0.5 * (edges[1] * (along + 1.0)) + edges[:-1, None]).ravel()
    r, mu = np.exp(logarithm), 0.5 * (around + 1.0)
    volume = 2.0 * np.pi * (0.5 * edges[1] * np.tile(along_weight, PIECES) * r**3)[:, None] * around_weight
    spline = BSpline(knots, np.eye(len(knots) - DEGREE - 1), DEGREE)
    values, slopes, bends = (spline(logarithm, order) for order in range(3))
    radial = values, slopes / r[:, None], (bends - slopes) / r[:, None] ** 2
    columns = [_strain_rate(k, r, radial, mu) for k in range(1, 2 * modes, 2)]
    # On the sphere the first two splines alone have values and slopes; a velocity of 1 wants ½ and 1.
    sphere = 0.5 * columns[0][..., 0] + (0.5 + edges[1] / DEGREE) * columns[0][..., 1]
    return np.concatenate([column[..., 2:-2] for column in columns], axis=2), sphere, volume.ravel()


def _strain_rate(
    k: int, r: FloatArray, radial: tuple[FloatArray, FloatArray, FloatArray], mu: FloatArray
) -> FloatArray:
    """Strain rates of f(r) (1 - μ²) P_k'(μ), scaled so that the sum of their squares is that of the shear rate."""
    r, mu = r[:, None, None], mu[None, :, None]
    f, slope, bend = (each[:, None, :] for each in radial)
    p, first, second = (Legendre.basis(k).deriv(order)(mu) for order in range(3))
    n, sine = k * (k + 1.0), np.sqrt(1.0 - mu**2)
    stretch = n * p * (slope / r**2 - 2.0 * f / r**3)
    turned = slope / r**2 * (sine**2 * second - mu * first) + n * p * f / r**3
    ring = n * p * f / r**3 - slope / r**2 * mu * first
    shear = -0.5 * sine * first * (bend / r - 2.0 * slope / r**2 + n * f / r**3)
    rates = np.stack([stretch, turned, ring, np.sqrt(2.0) * shear], axis=2)
    return np.sqrt(2.0) * rates.reshape(-1, 4, rates.shape[3])
