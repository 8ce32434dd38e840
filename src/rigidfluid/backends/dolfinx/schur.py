"""Preconditioner of the Schur complement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx.fem.petsc import assemble_matrix
from petsc4py import PETSc

from rigidfluid.backends.dolfinx.forms import Forms
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.coefficients import Coefficients


@dataclass(frozen=True)
class SchurData:
    """Data of the Schur complement at present: the matrix' ``coefficients``, and the matrices' forms.

    ``open`` (owned vertices,): whether a pressure is prescribed there; ``enclosed``: whether it is nowhere.
    """

    coefficients: Coefficients
    forms: Forms
    open: BoolArray
    enclosed: bool


def schur_data(space: Space, forms: Forms, surfaces: Surfaces, coefficients: Coefficients) -> SchurData:
    """Collect the data of the Schur complement on the mesh as it lies now."""
    numbering = space.numbering
    is_open = np.zeros(numbering.vertices, dtype=bool)
    for face in surfaces.faces:
        if face.condition.is_open:
            is_open[face.nodes[face.nodes < numbering.vertices]] = True
    return SchurData(coefficients, forms, is_open[space.owned_vertices], surfaces.enclosed)


class CahouetChabard:
    """S⁻¹ ≈ -(M⁻¹ + inertia L⁻¹), M the pressures' mass matrix weighted by 1/(2 μ + γ), L their Laplace matrix.

    Exact for A = inertia I - (2 μ + γ) ∇∇· on a whole space: what ∇u + ∇uᵀ and grad-div make of gradients (Cahouet and
    Chabard 1988, doi:10.1002/fld.1650080802). L is but its diagonal at open faces, where the pressure is nearly given.
    """

    def __init__(self, data: SchurData) -> None:
        self._data, coefficients = data, data.coefficients
        self._mass = self._laplacian = None
        if coefficients.viscosity > 0.0:
            mass = data.forms.pressure_mass(
                1.0 / (2.0 * coefficients.viscosity * coefficients.local.of_cells + coefficients.grad_div)
            )
            self._mass = _solver(_assembled(mass), "jacobi", 1e-2)
        if coefficients.inertia > 0.0:
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
            y.scale(-1.0)
        if self._laplacian is not None:
            self._laplacian.solve(source, self._image)
            y.axpy(-self._data.coefficients.inertia, self._image)


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
