"""Exact force on two unequal spheres that approach along the line of their centres in Stokes flow.

In bispherical coordinates, as in `bispherical`, the stream function is (Stimson & Jeffery, Proc. R. Soc. Lond. A 111
(1926) 110, doi:10.1098/rspa.1926.0053)

    ψ = (cosh ξ - t)^(-3/2) Σ Uₙ(ξ) (Pₙ₋₁(t) - Pₙ₊₁(t)),

where Uₙ is a sum of exp(±(n - ½)ξ) and exp(±(n + 3/2)ξ), and of each n four equations give Uₙ and Uₙ' on the spheres.
The terms that decay away from a sphere give its force.
"""

from __future__ import annotations

import numpy as np
from bispherical import E_FOLDS, _coordinates


def force_of_approach(gap: float, radius_b: float) -> float:
    """Force on spheres of radius 1 and ``radius_b`` that move with speed 1 towards each other, over 6πμ, by gap.

    Parameters
    ----------
    gap : float
        Between the surfaces [radius].
    radius_b : float
        Of the second sphere [radius].
    """
    alpha, beta, c = _coordinates(gap, radius_b)
    n = np.arange(1.0, int(E_FOLDS / min(alpha, -beta)) + 10)
    rates, signs = np.array([n - 0.5, n + 1.5, n - 0.5, n + 1.5]), np.array([1.0, 1.0, -1.0, -1.0])[:, None]
    own = np.array([alpha, alpha, beta, beta])[:, None]
    decays = [np.exp(-rates * np.abs(own - at)) for at in (alpha, beta)]
    matrix = np.stack([decays[0], signs * rates * decays[0], decays[1], signs * rates * decays[1]])
    sides = []
    for at, speed in ((alpha, -1.0), (beta, 1.0)):
        scale = -(c**2) * speed * n * (n + 1) / (np.sqrt(2.0) * (2 * n - 1) * (2 * n + 1) * (2 * n + 3))
        near, far = np.exp(-(n - 0.5) * abs(at)), np.exp(-(n + 1.5) * abs(at))
        sides += [scale * ((2 * n + 3) * near - (2 * n - 1) * far)]
        sides += [np.sign(at) * scale * (2 * n - 1) * (2 * n + 3) / 2.0 * (far - near)]
    found = np.linalg.solve(np.moveaxis(matrix, 2, 0), np.array(sides).T[:, :, None])[:, :, 0]
    of_a = found[:, 0] * np.exp(-(n - 0.5) * alpha) + found[:, 1] * np.exp(-(n + 1.5) * alpha)
    return float(2.0 * np.sqrt(2.0) / (3.0 * c) * np.sum((2 * n + 1) * of_a))
