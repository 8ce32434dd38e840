"""Coefficients of the matrix of velocities and pressures, which an assembly turns into numbers."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix
from rigidfluid.taylor_hood.system.grad_div import grad_div_coefficient
from rigidfluid.taylor_hood.system.local_viscosity import UNIFORM, LocalViscosity


@dataclass(frozen=True, eq=False)
class Coefficients:
    """Coefficients of the matrix K of

    inertia (u, v) + (a·∇u, v) + ½ ((∇·c) u, v) + viscosity (∇u + ∇uᵀ, ∇v) + (γ ∇·u, ∇·v) - (p, ∇·v) - (∇·u, q).

    The viscosity is ``viscosity`` times ``local``. ``advection`` a and ``flow`` c, (nodes, d), already hold the
    density. ``grad_div`` γ (M,) [viscosity] is zero where ``viscosity`` is, and where a and c are.
    """

    inertia: float
    viscosity: float
    advection: FloatArray
    flow: FloatArray
    grad_div: FloatArray
    local: LocalViscosity = UNIFORM


def coefficients_of(numbering: Numbering, matrix: CoupledMatrix) -> Coefficients:
    """Coefficients of the fluid's part of a coupled matrix, stabilisation included."""
    grad_div = grad_div_coefficient(numbering, matrix)
    return Coefficients(matrix.inertia, matrix.viscosity, matrix.advection, matrix.flow, grad_div, matrix.local)
