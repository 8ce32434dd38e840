"""What an ideal fluid adds to the inertia of a body that moves through it."""

from __future__ import annotations

from math import pi, prod

import numpy as np

from rigidfluid.core.mechanics.facet_moments import facet_moments
from rigidfluid.core.model.interfaces import Body
from rigidfluid.core.model.types import FloatArray


def added_mass(body: Body) -> FloatArray:
    """Added mass over the fluid's density: of ellipsoids π diag(b², a²) in 2D, V diag(α/(2 - α), …) in 3D.

    Of shapes of facets that of the ellipsoid of their volume with second moments in the same ratio; of all others that
    of a ball of their volume, V/(d - 1): averaged over all directions none has less.

    α = abc ∫₀^∞ dλ / [(a² + λ) √((a² + λ)(b² + λ)(c² + λ))], and so on, of sum 2.

    Parameters
    ----------
    body : Body
        The shape; a, b[, c] are its semi-axes if it has some.

    Returns
    -------
    (d, d) array
        In the body's frame, in unbounded fluid; walls add to that [length^d].

    Notes
    -----
    Lamb, Hydrodynamics, 6th ed. 1932, §§ 71, 114; other shapes: Pólya, PNAS 33 (1947) 218,
    doi:10.1073/pnas.33.7.218.
    """
    axes = body.semi_axes
    if axes is not None:
        return _of_ellipsoid(axes)
    if body.facets is None:
        return body.volume / (body.dimension - 1.0) * np.eye(body.dimension)
    squares, along = np.linalg.eigh(facet_moments(body.facets).second)
    like = np.sqrt(squares)
    ball = pi if body.dimension == 2 else 4.0 / 3.0 * pi
    like *= (body.volume / (ball * prod(like))) ** (1.0 / body.dimension)
    return np.asarray(along @ _of_ellipsoid(like) @ along.T)


def _of_ellipsoid(axes: FloatArray) -> FloatArray:
    """Along its ``axes``, its semi-axes (d,)."""
    if len(axes) == 2:
        return pi * np.diag(axes[::-1] ** 2)
    alpha = _lamb_integrals(axes)
    return 4.0 / 3.0 * pi * prod(axes) * np.diag(alpha / (2.0 - alpha))


def _lamb_integrals(semi_axes: FloatArray) -> FloatArray:
    """α, β, γ (3,) by Carlson's R_D."""
    from scipy.special import elliprd

    squares = semi_axes**2
    integrals = [elliprd(squares[(axis + 1) % 3], squares[(axis + 2) % 3], squares[axis]) for axis in range(3)]
    return 2.0 / 3.0 * prod(semi_axes) * np.array(integrals)
