"""Stress of a solid that yields, made smooth at rest."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


def yielding_viscosity(shear_rate: FloatArray, yield_stress: float, stress_growth: float) -> FloatArray:
    """τ_y (1 - exp(-m γ̇)) / γ̇ of shear rates (N,) [1/time], with the time m ``stress_growth``: m τ_y at rest.

    References
    ----------
    T. C. Papanastasiou, Flows of materials with yield, J. Rheol. 31, 385 (1987).
    """
    grown = stress_growth * shear_rate
    share = np.ones_like(grown)
    np.divide(-np.expm1(-grown), grown, out=share, where=grown > 0.0)
    return np.asarray(yield_stress * stress_growth * share)
