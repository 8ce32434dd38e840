"""Added mass of bodies in an ideal fluid."""

from __future__ import annotations

from math import pi, prod

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_moments import facet_moments
from rigidfluid.core.model.body import Body


def added_mass(body: Body) -> FloatArray:
    """Added mass over the fluid's density in the body's frame (d, d), in unbounded fluid; walls increase it [length^d].

    Ellipses have π diag(b², a²), ellipsoids V diag(α/(2 - α), …) (Lamb, Hydrodynamics, 6th ed. 1932, §§ 71, 114), with

        α = abc ∫₀^∞ dλ / [(a² + λ) √((a² + λ)(b² + λ)(c² + λ))], and so on, of sum 2.

    Shapes of facets are taken for the ellipsoid of their volume with second moments in the same ratio, all others for
    the ball of their volume, V/(d - 1): averaged over all directions none has less (Pólya, PNAS 33 (1947) 218,
    doi:10.1073/pnas.33.7.218).
    """
    axes = body.semi_axes
    if axes is not None:
        return _ellipsoid_added_mass(axes)
    if body.facets is None:
        return body.volume / (body.dimension - 1.0) * np.eye(body.dimension)
    squares, along = np.linalg.eigh(facet_moments(body.facets).second)
    like = np.sqrt(squares)
    ball = pi if body.dimension == 2 else 4.0 / 3.0 * pi
    like *= (body.volume / (ball * prod(like))) ** (1.0 / body.dimension)
    return np.asarray(along @ _ellipsoid_added_mass(like) @ along.T)


def _ellipsoid_added_mass(axes: FloatArray) -> FloatArray:
    """Added mass over density (d, d) of an ellipsoid along its axes, of semi-axes (d,) [length^d]."""
    if len(axes) == 2:
        return pi * np.diag(axes[::-1] ** 2)
    alpha = _lamb_integrals(axes)
    return 4.0 / 3.0 * pi * prod(axes) * np.diag(alpha / (2.0 - alpha))


def _lamb_integrals(semi_axes: FloatArray) -> FloatArray:
    """Lamb's integrals α, β, γ (3,) by Carlson's R_D [1]."""
    from scipy.special import elliprd

    squares = semi_axes**2
    integrals = [elliprd(squares[(axis + 1) % 3], squares[(axis + 2) % 3], squares[axis]) for axis in range(3)]
    return 2.0 / 3.0 * prod(semi_axes) * np.array(integrals)
