"""Viscosity that stands for a film in which it varies: the whole film resists as one of this viscosity does."""

from __future__ import annotations

from functools import cache
from math import exp, sqrt

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.types import Material

_PLACES = 12

_MEAN_RATE = exp(-1.0 / 3.0)
"""Shear rate that stands for the flow between two plates over that of a Newtonian fluid at the plates, for power laws
of an exponent near one."""


def film_viscosity(
    material: Material, gap: FloatArray, radius: FloatArray, closing: FloatArray, passing: FloatArray, dimension: int
) -> FloatArray:
    """Viscosity (m,) of a film of thickness ``gap`` h and effective ``radius`` R between surfaces that come closer at
    the speed ``closing`` v and pass each other at ``passing``, (m,) each [mass·length^(2-d)/time].

    In the film h(r) = h + r²/(2R) the force is ∫ μ(r) w(r) dr with the weight w of a Newtonian film. μ(r) is that at
    the shear rate √(γ_v² + γ_p²), γ_v = e^(-1/3) 3 v r/h(r)² in 3D and twice that in 2D, and γ_p the speed ``passing``
    over h(r). With t = r²/(2R h(r)) the weight is 2t in 3D and (8/π) √(t(1 - t)) in 2D, from 0 to 1.
    """
    if not isinstance(material, GeneralisedNewtonian):
        return np.full(len(gap), material.dynamic_viscosity)
    t, weight = _places(dimension)
    squeezed = (3.0 if dimension == 3 else 6.0) * _MEAN_RATE * sqrt(2.0) * closing * np.sqrt(radius) / gap**1.5
    rate = np.hypot(np.outer(np.sqrt(t) * (1.0 - t) ** 1.5, squeezed), np.outer(1.0 - t, passing / gap))
    return np.asarray(weight @ material.viscosity(rate.ravel()).reshape(rate.shape))


@cache
def _places(dimension: int) -> tuple[FloatArray, FloatArray]:
    """Gauss points t and weights of sum one; in 3D of t², in 2D Chebyshev's of the second kind."""
    if dimension == 3:
        squares, weight = np.polynomial.legendre.leggauss(_PLACES)
        return np.sqrt(0.5 * (1.0 + squares)), 0.5 * weight
    angle = np.pi * np.arange(1, _PLACES + 1) / (_PLACES + 1)
    return 0.5 * (1.0 - np.cos(angle)), 2.0 / (_PLACES + 1) * np.sin(angle) ** 2
