"""Grad-div stabilisation: the coefficient of (∇·u, ∇·v) in each cell, and the power that it takes."""

from __future__ import annotations

from math import factorial

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix
from rigidfluid.taylor_hood.system.discretisation import Discretisation

_CONVECTION, _VISCOSITY = 2.0, 4.0
"""Weights of ρ|u*|h and of μ. The extrapolated ½(∇·u*)u feeds divergence of wave number π/h back at up to 3/2 times
ρ|u*|π/h; the implicit terms take (γ + 2μ)(π/h)², which is more where γ > ½ ρ|u*|h - 2μ. More is taken, since |u*| is
the least of a cell: so cells at surfaces at rest, which hold the divergence down themselves, keep their drag."""


def grad_div_coefficient(numbering: Numbering, matrix: CoupledMatrix) -> FloatArray:
    r"""Grad-div coefficient of each cell, (M,) [dynamic viscosity].

    γ = max(0, 2 ρ|u*|h - 4 μ), |u*| the least of a cell's nodes, h = (d! volume)^(1/d). It vanishes where the cell's
    Reynolds number ρ|u*|h/μ is below 2: there viscosity takes enough.

    Parameters
    ----------
    numbering : Numbering
        The topology.
    matrix : CoupledMatrix
        Its points (vertices + K, d) [length], flow ρu* (nodes, d) [density · velocity] and viscosity μ, the mean of
        each cell.

    Notes
    -----
    Olshanskii (2002), doi:10.1016/S0045-7825(02)00513-3; Jenkins, John, Linke and Rebholz (2014),
    doi:10.1007/s10444-013-9316-1.
    """
    cells, d = numbering.cells, numbering.dimension
    size = (factorial(d) * np.abs(cell_volumes(matrix.points[: numbering.vertices], cells))) ** (1.0 / d)
    flow = np.linalg.norm(matrix.flow, axis=1)[numbering.cell_nodes].min(axis=1)
    taken = _VISCOSITY * matrix.viscosity * matrix.local.of_cells
    return np.asarray(np.maximum(_CONVECTION * flow * size - taken, 0.0))


def grad_div_dissipation(discretisation: Discretisation, matrix: CoupledMatrix, velocity: FloatArray) -> float:
    """∫ γ (∇·u)² of a ``velocity`` (nodes, d) at the end of the step of a ``matrix`` [energy/time]."""
    gamma = grad_div_coefficient(discretisation.numbering, matrix)
    taken = discretisation.divergence_square(matrix.points, velocity, gamma) if gamma.any() else 0.0
    return float(discretisation.surfaces.ranks.sum(taken))
