"""Preconditioners of the blocks: Cahouet–Chabard for the Schur complement, Jacobi or multigrid for the velocities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from rigidfluid.backends.dolfinx.forms import Forms
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.types import BoolArray, FloatArray
from rigidfluid.taylor_hood.surfaces import Surfaces

if TYPE_CHECKING:
    from rigidfluid.backends.dolfinx.reduced import Reduced

MASS_DOMINATES = 1e-3
"""From this inertia · h² / viscosity on, h of the smallest cell, Jacobi serves the velocities better than multigrid."""


@dataclass(frozen=True)
class SchurData:
    """What the Schur complement is made of at present: weights ``inertia`` of (u, v) and ``viscosity`` of
    (∇u + ∇uᵀ, ∇v), the matrices' forms, ``cell`` the smallest cell's size [length].

    ``open`` (owned vertices,): where a pressure is prescribed; ``enclosed``: nowhere.
    """

    inertia: float
    viscosity: float
    forms: Forms
    cell: float
    open: BoolArray
    enclosed: bool


def schur_data(
    space: Space, forms: Forms, surfaces: Surfaces, points: FloatArray, inertia: float, viscosity: float
) -> SchurData:
    """For the mesh at ``points``."""
    numbering = space.numbering
    volume = surfaces.ranks.min(np.abs(cell_volumes(points, numbering.cells)).min())
    is_open = np.zeros(numbering.vertices, dtype=bool)
    for face in surfaces.faces:
        if face.condition.type == "pressure":
            is_open[face.nodes[face.nodes < numbering.vertices]] = True
    cell = float(volume ** (1.0 / numbering.dimension))
    return SchurData(inertia, viscosity, forms, cell, is_open[space.owned_vertices], surfaces.enclosed)


_MULTIGRID: dict[str, str | int] = {"pc_type": "gamg", "pc_gamg_aggressive_coarsening": 0}
"""PETSc's own choice squares the graph, where a body's row joins all nodes on it: fifteen times the memory."""


def velocity_options(matrix: Reduced) -> dict[str, str | int]:
    """By mass dominance."""
    schur = matrix.schur()
    by_mass = schur.inertia * schur.cell**2 > MASS_DOMINATES * schur.viscosity
    jacobi: dict[str, str | int] = {"pc_type": "jacobi"}
    options = jacobi if by_mass else _MULTIGRID
    return {f"fieldsplit_velocity_{key}": value for key, value in options.items()}


class CahouetChabard:
    """S⁻¹ ≈ -(2 μ M⁻¹ + inertia L⁻¹), M the mass and L the Laplace matrix of the pressures.

    Exact for A = inertia I - 2 μ ∇∇· on a whole space: what ∇u + ∇uᵀ makes of gradients (Cahouet and Chabard 1988,
    doi:10.1002/fld.1650080802). At open faces, where the pressure is nearly given, L is but its diagonal.
    """

    def __init__(self, data: SchurData) -> None:
        self._data = data
        self._mass = self._laplacian = None
        if data.viscosity > 0.0:
            self._mass = _solver(_assembled(data.forms.pressure_mass), "jacobi", 1e-2)
        if data.inertia > 0.0:
            matrix = _assembled(data.forms.pressure_laplacian)
            first = matrix.getOwnershipRange()[0]
            held = (first + np.flatnonzero(data.open)).astype(PETSc.IntType)
            diagonal = matrix.getDiagonal()
            matrix.zeroRowsColumns(held, 1.0)
            matrix.setDiagonal(diagonal)
            if data.enclosed:
                matrix.setNullSpace(PETSc.NullSpace().create(constant=True, comm=matrix.comm))
            self._laplacian = _solver(matrix, "hypre", 1e-2)
            self._image = matrix.createVecRight()

    def apply(self, _pc: Any, x: Any, y: Any) -> None:
        """Called by PETSc: y = S⁻¹ x."""
        y.set(0.0)
        source = x.duplicate()
        x.copy(source)
        if self._data.enclosed:
            source.shift(-source.sum() / source.getSize())
        if self._mass is not None:
            self._mass.solve(source, y)
            y.scale(-2.0 * self._data.viscosity)
        if self._laplacian is not None:
            self._laplacian.solve(source, self._image)
            y.axpy(-self._data.inertia, self._image)


def _assembled(form: Any) -> Any:
    matrix = assemble_matrix(form)
    matrix.assemble()
    return matrix


def _solver(matrix: Any, preconditioner: str, tolerance: float) -> Any:
    ksp = PETSc.KSP().create(matrix.comm)
    ksp.setOperators(matrix)
    ksp.setType("cg")
    ksp.setTolerances(rtol=tolerance, max_it=20)
    ksp.getPC().setType(preconditioner)
    ksp.setUp()
    return ksp
