"""What an ideal fluid adds to the inertia of a body that moves through it."""

from __future__ import annotations

from math import pi, prod

import numpy as np

from rigidfluid.core.interfaces import Body
from rigidfluid.core.types import FloatArray


def added_mass(body: Body) -> FloatArray:
    """Added mass over the fluid's density: of ellipsoids π diag(b², a²) in 2D, V diag(α/(2 - α), …) in 3D; else zero.

    α = abc ∫₀^∞ dλ / [(a² + λ) √((a² + λ)(b² + λ)(c² + λ))], and so on, of sum 2.

    Parameters
    ----------
    body : Body
        The shape, of semi-axes a, b[, c].

    Returns
    -------
    (d, d) array
        In the body's frame, in unbounded fluid; walls add to that [length^d].

    Notes
    -----
    Lamb, Hydrodynamics, 6th ed. 1932, §§ 71, 114.
    """
    axes = body.semi_axes
    if axes is None:
        return np.zeros((body.dimension, body.dimension))
    if len(axes) == 2:
        return pi * np.diag(axes[::-1] ** 2)
    alpha = _lamb_integrals(axes)
    return 4.0 / 3.0 * pi * prod(axes) * np.diag(alpha / (2.0 - alpha))


def added_inertia(body: Body) -> FloatArray:
    """Added moment of inertia over the fluid's density: of ellipsoids, zero about an axis of revolution; else zero.

    In 2D π(a² - b²)²/8, in 3D about the first axis V (b² - c²)² (γ - β) / {5 [2(b² - c²) + (b² + c²)(β - γ)]}.

    Parameters
    ----------
    body : Body
        The shape, of semi-axes a, b[, c].

    Returns
    -------
    (k, k) array
        In the body's frame, about the centre [length^(d+2)].

    Notes
    -----
    Lamb, Hydrodynamics, 6th ed. 1932, §§ 71, 115; the integrals are those of `added_mass`.
    """
    axes = body.semi_axes
    if axes is None:
        return np.zeros_like(body.gyration)
    squares = axes**2
    if len(axes) == 2:
        return np.full((1, 1), pi / 8.0 * (squares[0] - squares[1]) ** 2)
    alpha = _lamb_integrals(axes)
    moments = np.zeros(3)
    for axis in range(3):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        difference, total, slope = squares[j] - squares[k], squares[j] + squares[k], alpha[k] - alpha[j]
        if abs(difference) > 1e-9 * total:
            moments[axis] = difference**2 * slope / (2.0 * difference - total * slope) / 5.0
    return 4.0 / 3.0 * pi * prod(axes) * np.diag(moments)


def _lamb_integrals(semi_axes: FloatArray) -> FloatArray:
    """α, β, γ (3,) by Carlson's R_D."""
    from scipy.special import elliprd

    squares = semi_axes**2
    integrals = [elliprd(squares[(axis + 1) % 3], squares[(axis + 2) % 3], squares[axis]) for axis in range(3)]
    return 2.0 / 3.0 * prod(semi_axes) * np.array(integrals)
