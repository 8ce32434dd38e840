"""The integrals of the Taylor–Hood system over all cells: scikit-fem's elements, tabulated for compiled loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rigidfluid.backends.scikit_fem import kernels
from rigidfluid.core.model.types import FloatArray
from rigidfluid.taylor_hood.numbering import Numbering


@dataclass(frozen=True)
class ReferenceTables:
    """Basis values and gradients on the reference simplex at quadrature points, and its exact mass matrix.

    ``value`` (Q, b), ``gradient`` (Q, b, d), ``weight`` (Q,): exact to degree 5, for the convection.
    ``flat_gradient`` (S, b, d), ``flat_linear`` (S, d+1), ``flat_weight`` (S,): degree 2, for stress and divergence.
    ``mass`` (b, b).
    """

    value: FloatArray
    gradient: FloatArray
    weight: FloatArray
    flat_gradient: FloatArray
    flat_linear: FloatArray
    flat_weight: FloatArray
    mass: FloatArray


def reference_tables(dimension: int) -> ReferenceTables:
    """Tabulate scikit-fem's quadratic simplex in ``dimension`` 2 or 3."""
    from skfem import ElementTetP2, ElementTriP2
    from skfem.quadrature import get_quadrature

    element = (ElementTriP2 if dimension == 2 else ElementTetP2)()
    count = len(element.doflocs)

    def tabulate(order: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        points, weight = get_quadrature(element.refdom, order)
        basis = [element.lbasis(points, i) for i in range(count)]
        value = np.array([phi for phi, _ in basis]).T.copy()
        gradient = np.moveaxis(np.array([grad for _, grad in basis]), 2, 0).copy()
        return points, weight, value, gradient

    # In tetrahedra scikit-fem's rule of order 5 is exact to degree 4 only, and that of order 6 to degree 5.
    _, weight, value, gradient = tabulate(5 if dimension == 2 else 6)
    points, flat_weight, _, flat_gradient = tabulate(2)
    linear = np.column_stack([1.0 - points.sum(axis=0), points.T])
    return ReferenceTables(
        value, gradient, weight, flat_gradient, linear, flat_weight, np.einsum("q,qi,qj->ij", weight, value, value)
    )


class CompiledAssembly:
    """Matrices and loads on the cells of ``numbering``; their sparsity is laid out once."""

    def __init__(self, numbering: Numbering) -> None:
        self.numbering = numbering
        self._tables = reference_tables(numbering.dimension)
        self._build_sparsity()

    def matrix(
        self, points: FloatArray, inertia: float, viscosity: float, advection: FloatArray, flow: FloatArray
    ) -> sparse.csr_array:
        n, t = self.numbering, self._tables
        data = kernels.assemble(
            points, n.cells, n.cell_nodes, self._slots, len(self._indices), inertia, viscosity, advection, flow,
            t.value, t.gradient, t.weight, t.flat_gradient, t.flat_linear, t.flat_weight, t.mass,
        )  # fmt: skip
        return sparse.csr_array((data, self._indices, self._indptr), shape=(n.unknowns,) * 2)

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        n = self.numbering
        load: FloatArray = kernels.apply_mass(points, n.cells, n.cell_nodes, self._tables.mass, field)
        return load

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        n, t = self.numbering, self._tables
        return float(kernels.strain_square(points, n.cells, n.cell_nodes, t.flat_gradient, t.flat_weight, velocity))

    def _build_sparsity(self) -> None:
        n, d = self.numbering, self.numbering.dimension
        velocity = (n.cell_nodes[:, :, None] * d + np.arange(d)).reshape(len(n.cells), -1)
        unknowns = np.concatenate([velocity, n.nodes * d + n.cells], axis=1)
        width = unknowns.shape[1]
        rows = np.repeat(unknowns, width, axis=1).ravel()
        columns = np.tile(unknowns, (1, width)).ravel()
        pattern = sparse.coo_array((np.ones(len(rows)), (rows, columns)), shape=(n.unknowns,) * 2).tocsr()
        pattern.sort_indices()
        self._indptr = pattern.indptr.astype(np.int32)
        self._indices = pattern.indices.astype(np.int32)
        self._slots = kernels.slots(self._indptr, self._indices, unknowns)
