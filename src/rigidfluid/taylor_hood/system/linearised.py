"""Viscous stress of a generalised Newtonian fluid, linear about a flow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.discretisation import Discretisation
from rigidfluid.taylor_hood.system.local_viscosity import UNIFORM, LocalViscosity, StrainRates

_DIFFERENCE = 1e-5
"""Half the difference of log γ̇ by which viscosities are differentiated: its error is about 10⁻¹⁰ of them."""


@dataclass(frozen=True, eq=False)
class Linearised:
    """Stress with a ``local`` viscosity, and the ``load`` (nodes, d) that makes up for what is not linear in it."""

    local: LocalViscosity
    load: FloatArray


def linearised(discretisation: Discretisation, points: FloatArray, velocity: FloatArray) -> Linearised:
    """Stress of a generalised Newtonian fluid about a ``velocity`` u (nodes, d), to first order:

    σ(w) ≈ μ(∇w + ∇wᵀ) + μ' (T:∇w) T - μ' γ̇ T, with T = (∇u + ∇uᵀ)/γ̇ and μ' = dμ/d log γ̇ at u.
    """
    material, strain = discretisation.problem.material, discretisation.strain_rates(points, velocity)
    local = _local_viscosity(material, strain)
    slope = material.dynamic_viscosity * local.slope
    return Linearised(local, discretisation.stress_load(points, slope[:, None, None] * strain.tensor))


def local_viscosity(discretisation: Discretisation, points: FloatArray, velocity: FloatArray) -> LocalViscosity:
    """Viscosity of any fluid about a ``velocity`` (nodes, d), and how it changes there."""
    material = discretisation.problem.material
    if isinstance(material, Newtonian):
        return UNIFORM
    return _local_viscosity(material, discretisation.strain_rates(points, velocity))


def _local_viscosity(material: Material, strain: StrainRates) -> LocalViscosity:
    rate, scale = strain.shear_rate, material.dynamic_viscosity
    relative = material.viscosity(rate) / scale
    ends = (material.viscosity(rate * (1.0 + sign * _DIFFERENCE)) for sign in (1.0, -1.0))
    slope = np.subtract(*ends) / (2.0 * _DIFFERENCE * scale)
    direction = np.divide(
        strain.tensor, rate[:, None, None], out=np.zeros_like(strain.tensor), where=rate[:, None, None] > 0.0
    )
    return LocalViscosity(relative, slope, direction, strain.cell_means(relative))


def relative_change(
    discretisation: Discretisation,
    matrix_points: FloatArray,
    velocity: FloatArray,
    other: FloatArray,
    local: LocalViscosity,
) -> float:
    """√(D(v - u)/D(v)) of a ``velocity`` u and an ``other`` v, with D(w) = ∫ μ |∇w + ∇wᵀ|² of a ``local`` viscosity."""
    change, whole = (discretisation.strain_rates(matrix_points, each) for each in (other - velocity, other))
    squares = [np.sum(each.weight * local.relative * each.shear_rate**2) for each in (change, whole)]
    of_change, of_all = discretisation.surfaces.ranks.sum(np.array(squares))
    return float(np.sqrt(of_change / of_all)) if of_all > 0.0 else 0.0
