"""Exact resistance of two unequal spheres that move along the line of their centres in Stokes flow.

In bispherical coordinates, as in `bispherical`, the stream function is (Stimson & Jeffery, Proc. R. Soc. Lond. A 111
(1926) 110, doi:10.1098/rspa.1926.0053)

    ψ = (cosh ξ - t)^(-3/2) Σ Uₙ(ξ) (Pₙ₋₁(t) - Pₙ₊₁(t)),

where Uₙ is a sum of exp(±(n - ½)ξ) and exp(±(n + 3/2)ξ), and of each n four equations give Uₙ and Uₙ' on the spheres.
The terms that decay away from a sphere give its force.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from bispherical import E_FOLDS, FloatArray, coordinates


@cache
def approach(gap: float, radius_b: float) -> FloatArray:
    """Resistance of spheres of radius 1 and ``radius_b`` to velocities along the line of their centres, with viscosity
    1, (2, 2)."""
    a, both = (_force(gap, radius_b, *speeds) for speeds in ((1.0, 0.0), (0.0, 1.0)))
    return np.array([[a, both], [both, radius_b * _force(gap / radius_b, 1.0 / radius_b, 1.0, 0.0)]])


def _force(gap: float, radius_b: float, speed_a: float, speed_b: float) -> float:
    """Force that the sphere of radius 1 exerts on the fluid."""
    alpha, beta, c = coordinates(gap, radius_b)
    n = np.arange(1.0, int(E_FOLDS / min(alpha, -beta)) + 10)
    rates, signs = np.array([n - 0.5, n + 1.5, n - 0.5, n + 1.5]), np.array([1.0, 1.0, -1.0, -1.0])[:, None]
    own = np.array([alpha, alpha, beta, beta])[:, None]
    decays = [np.exp(-rates * np.abs(own - at)) for at in (alpha, beta)]
    matrix = np.stack([decays[0], signs * rates * decays[0], decays[1], signs * rates * decays[1]])
    sides = []
    for at, speed in ((alpha, speed_a), (beta, speed_b)):
        scale = -(c**2) * speed * n * (n + 1) / (np.sqrt(2.0) * (2 * n - 1) * (2 * n + 1) * (2 * n + 3))
        near, far = np.exp(-(n - 0.5) * abs(at)), np.exp(-(n + 1.5) * abs(at))
        sides += [scale * ((2 * n + 3) * near - (2 * n - 1) * far)]
        sides += [np.sign(at) * scale * (2 * n - 1) * (2 * n + 3) / 2.0 * (far - near)]
    found = np.linalg.solve(np.moveaxis(matrix, 2, 0), np.array(sides).T[:, :, None])[:, :, 0]
    of_a = found[:, 0] * np.exp(-(n - 0.5) * alpha) + found[:, 1] * np.exp(-(n + 1.5) * alpha)
    return float(-4.0 * np.sqrt(2.0) * np.pi / c * np.sum((2 * n + 1) * of_a))
