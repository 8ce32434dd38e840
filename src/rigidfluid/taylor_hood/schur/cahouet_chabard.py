"""The Schur complement of the pressures, by Cahouet and Chabard."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.taylor_hood.elements.linear_functions import gradients
from rigidfluid.taylor_hood.linear_solver.factorization import Factors, factorise
from rigidfluid.taylor_hood.linear_solver.pardiso import Orderings
from rigidfluid.taylor_hood.system.constraint import Constraint
from rigidfluid.taylor_hood.system.parts import Parts


class CahouetChabard:
    """S⁻¹ ≈ -(M⁻¹ + inertia L⁻¹), M the pressures' mass matrix weighted by 1/(2 μ + γ), L their Laplace matrix.

    Exact for A = inertia I - (2 μ + γ) ∇∇· on a whole space: what ∇u + ∇uᵀ and grad-div make of gradients (Cahouet and
    Chabard 1988, doi:10.1002/fld.1650080802). L is but its diagonal at open faces, where the pressure is nearly given.
    Both have as many rows as the mesh has vertices, a twentieth of the unknowns in 3D, and are factorised.

    Parameters
    ----------
    parts : Parts
        Ingredients of the coupled matrix.
    """

    def __init__(self, parts: Parts) -> None:
        constraint, coefficients = parts.constraint, parts.coefficients
        self._which, self._count = _pressures(constraint)
        self._pin = constraint.pressure_pin
        numbering = constraint.surfaces.numbering
        resisted = 2.0 * coefficients.viscosity * coefficients.local.of_cells + coefficients.grad_div
        points = parts.points[: numbering.vertices]
        mass, laplacian = _integrals(numbering.cells, points, self._which, self._count, resisted)
        self._terms: list[Factors] = []
        orderings = Orderings()  # both have the same pattern
        if coefficients.viscosity > 0.0:
            self._terms.append(factorise(mass, None, orderings))
        if coefficients.inertia > 0.0:
            held = _open_vertices(constraint)
            grounded = _decoupled(laplacian, np.unique(self._which[held]))
            if self._pin is not None:  # known up to a constant
                pin = np.zeros(self._count)
                pin[self._which[self._pin]] = laplacian.diagonal()[self._which[self._pin]]
                grounded = grounded + sparse.diags_array(pin)
            self._terms.append(factorise(sparse.csr_array(grounded / coefficients.inertia), None, orderings))

    def solve(self, right_side: FloatArray) -> FloatArray:
        """S⁻¹ of the pressures' residual (pressures,), without that at the pin."""
        if self._pin is None:
            return self._solve(right_side)
        pin = self._which[self._pin]
        found = self._solve(np.insert(right_side, pin, -right_side.sum()))  # what flows out there flows in elsewhere
        return np.delete(found - found[pin], pin)

    def _solve(self, right_side: FloatArray) -> FloatArray:
        found = np.zeros_like(right_side)
        for term in self._terms:
            found -= term.solve(right_side)
        return found


def _pressures(constraint: Constraint) -> tuple[IntArray, int]:
    """The number of the pressure at each vertex, that at the pin included, and how many there are."""
    surfaces = constraint.surfaces
    which, number = np.unique(surfaces.originals[: surfaces.numbering.vertices], return_inverse=True)
    return number, len(which)


def _open_vertices(constraint: Constraint) -> IntArray:
    """Vertices (v,) at which a pressure is prescribed."""
    vertices = constraint.surfaces.numbering.vertices
    on = [face.nodes for face in constraint.surfaces.faces if face.condition.is_open]
    nodes = np.concatenate([np.empty(0, np.int64), *on])
    return nodes[nodes < vertices]


def _integrals(
    cells: IntArray, points: FloatArray, number: IntArray, count: int, resisted: FloatArray
) -> tuple[sparse.csr_array, sparse.csr_array]:
    """(p/c, q) with c ``resisted`` (M,), and (∇p, ∇q), of linear functions, numbered by ``number`` of each vertex."""
    d = points.shape[1]
    corners = points[cells]
    jacobian = np.moveaxis(corners[:, 1:] - corners[:, :1], 1, 2)
    volume = np.abs(np.linalg.det(jacobian)) / (2.0 if d == 2 else 6.0)
    gradient = gradients(corners)
    laplacian = volume[:, None, None] * (gradient @ np.moveaxis(gradient, 1, 2))
    share = np.divide(volume, resisted, out=np.zeros_like(volume), where=resisted > 0.0)
    mass = share[:, None, None] * (np.ones((d + 1, d + 1)) + np.eye(d + 1)) / ((d + 1) * (d + 2))
    place = np.broadcast_arrays(number[cells][:, :, None], number[cells][:, None, :])
    rows, columns = (each.ravel() for each in place)
    found = (
        sparse.coo_array((each.ravel(), (rows, columns)), shape=(count, count)).tocsr() for each in (mass, laplacian)
    )
    mass_matrix, laplace_matrix = found
    return mass_matrix, laplace_matrix


def _decoupled(matrix: sparse.csr_array, rows: IntArray) -> sparse.csr_array:
    """The matrix with the off-diagonal entries of these rows and columns left out."""
    keep = np.ones(matrix.shape[0])
    keep[rows] = 0.0
    kept = sparse.diags_array(keep)
    return sparse.csr_array(kept @ matrix @ kept + sparse.diags_array((1.0 - keep) * matrix.diagonal()))
