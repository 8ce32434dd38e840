"""The Taylor–Hood space P2–P1 on one topology: numbering, reference tables and the sparsity of the system matrix.

Nodes carry the velocity: the vertices first, then the edges' midpoints. Unknown ``node * d + component`` is a velocity,
unknown ``nodes * d + vertex`` a pressure. Nothing here depends on where the vertices are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from rigidfluid.backends.scikit_fem import kernels
from rigidfluid.core.types import FloatArray, IntArray


@dataclass(frozen=True)
class ReferenceTables:
    """Basis values and gradients on the reference simplex at quadrature points, and its exact mass matrix.

    ``value`` (Q, b), ``gradient`` (Q, b, d), ``weight`` (Q,): rule of degree 5, exact for the convection.
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

    _, weight, value, gradient = tabulate(5)
    points, flat_weight, _, flat_gradient = tabulate(2)
    linear = np.column_stack([1.0 - points.sum(axis=0), points.T])
    return ReferenceTables(
        value, gradient, weight, flat_gradient, linear, flat_weight, np.einsum("q,qi,qj->ij", weight, value, value)
    )


class TaylorHood:
    """Numbering and sparsity of the P2–P1 system on ``cells`` (M, d+1) over ``vertices`` vertices."""

    def __init__(self, cells: IntArray, vertices: int) -> None:
        from skfem import ElementTetP2, ElementTriP2, MeshTet, MeshTri
        from skfem.assembly import Dofs

        self.cells = cells
        self.dimension = d = cells.shape[1] - 1
        self.vertices = vertices
        mesh_type, element = (MeshTri, ElementTriP2()) if d == 2 else (MeshTet, ElementTetP2())
        mesh = mesh_type(np.zeros((d, vertices)), np.ascontiguousarray(cells.T))
        self.edges: IntArray = np.sort((mesh.facets if d == 2 else mesh.edges).T, axis=1).astype(np.int64)
        self.nodes = vertices + len(self.edges)
        self.cell_nodes: IntArray = np.ascontiguousarray(Dofs(mesh, element).element_dofs.T, dtype=np.int64)
        self.cell_vertices: IntArray = np.ascontiguousarray(mesh.t.T, dtype=np.int64)
        self.tables = reference_tables(d)
        self._edge_keys = self.edges[:, 0] * vertices + self.edges[:, 1]
        self._edge_order = np.argsort(self._edge_keys)
        self._build_sparsity()

    @property
    def unknowns(self) -> int:
        """Velocity and pressure unknowns before any constraint."""
        return int(self.nodes * self.dimension + self.vertices)

    def _build_sparsity(self) -> None:
        d = self.dimension
        velocity = (self.cell_nodes[:, :, None] * d + np.arange(d)).reshape(len(self.cells), -1)
        unknowns = np.concatenate([velocity, self.nodes * d + self.cell_vertices], axis=1)
        width = unknowns.shape[1]
        rows = np.repeat(unknowns, width, axis=1).ravel()
        columns = np.tile(unknowns, (1, width)).ravel()
        pattern = sparse.coo_array((np.ones(len(rows)), (rows, columns)), shape=(self.unknowns,) * 2).tocsr()
        pattern.sort_indices()
        self.indptr = pattern.indptr.astype(np.int32)
        self.indices = pattern.indices.astype(np.int32)
        self.slots = kernels.slots(self.indptr, self.indices, unknowns)

    def matrix(self, data: FloatArray) -> sparse.csr_array:
        """The sparse matrix with this space's pattern and ``data``, without a copy."""
        return sparse.csr_array((data, self.indices, self.indptr), shape=(self.unknowns,) * 2)

    def node_points(self, points: FloatArray) -> FloatArray:
        """Coordinates of all nodes, (nodes, d), for vertices at ``points`` (vertices, d); also extends any P1 field."""
        return np.concatenate([points, 0.5 * (points[self.edges[:, 0]] + points[self.edges[:, 1]])])

    def facet_nodes(self, facets: IntArray) -> IntArray:
        """Nodes of boundary ``facets`` (F, d): their vertices, then their edges' midpoints; (F, 3 | 6)."""
        pairs = [(0, 1)] if self.dimension == 2 else [(0, 1), (1, 2), (0, 2)]
        midpoints = []
        for i, j in pairs:
            low, high = np.minimum(facets[:, i], facets[:, j]), np.maximum(facets[:, i], facets[:, j])
            found = np.searchsorted(self._edge_keys, low * self.vertices + high, sorter=self._edge_order)
            midpoints.append(self.vertices + self._edge_order[found])
        return np.column_stack([facets, *midpoints])
