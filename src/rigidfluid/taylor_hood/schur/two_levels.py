"""An approximate inverse of the velocities' block: component by component, on quadratic and on linear functions."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.linear_solver.factorization import factorise
from rigidfluid.taylor_hood.linear_solver.few_columns import times
from rigidfluid.taylor_hood.schur.incomplete_lu import IncompleteLU
from rigidfluid.taylor_hood.schur.scalar_space import ScalarSpace


class TwoLevels:
    """F⁻¹ ≈ by ILU(0), LU factors on the linear functions, and ILU(0) again.

    ILU(0) takes out what varies from node to node; what it leaves is smooth, and linear functions have it
    (p-multigrid).

    Parameters
    ----------
    space : ScalarSpace
        The unknowns of each component.
    matrix : csr_array
        F (nodes, nodes).
    masses : (s,) float
        Added on the diagonal.
    """

    def __init__(self, space: ScalarSpace, matrix: sparse.csr_array, masses: FloatArray) -> None:
        self._space = space
        self._matrix = sparse.csr_array(space.reduced(matrix) + sparse.diags_array(masses))
        self._matrix.sort_indices()
        self._smoother = IncompleteLU(self._matrix)
        self._restrict = sparse.csr_array(space.coarse.T)
        self._coarse = factorise(sparse.csr_array(self._restrict @ self._matrix @ space.coarse))

    def solve(self, right_sides: FloatArray) -> FloatArray:
        """F⁻¹ of one column for each component, (s, c), about."""
        found = self._smoother.solve(right_sides)
        left = right_sides - times(self._matrix, found)
        found += self._space.coarse @ self._coarse.solve(self._restrict @ left)
        found += self._smoother.solve(right_sides - times(self._matrix, found))
        return found


def mean_of_components(matrix: sparse.csr_array, nodes: int, dimension: int) -> sparse.csr_array:
    """The mean of the blocks of K that couple a component with itself, (nodes, nodes).

    The mean of viscosity (∇u + ∇uᵀ, ∇v) is (1 + 1/d) viscosity (∇u, ∇v).
    """
    indptr, indices, data = _mean(matrix.indptr, matrix.indices, matrix.data, nodes, dimension)
    return sparse.csr_array((data, indices, indptr), shape=(nodes, nodes))


@njit(cache=True)
def _mean(rows, columns, data, nodes, dimension):
    indptr = np.zeros(nodes + 1, np.int32)
    for node in range(nodes):
        row, count = node * dimension, 0
        for slot in range(rows[row], rows[row + 1]):
            count += columns[slot] < nodes * dimension and columns[slot] % dimension == 0
        indptr[node + 1] = indptr[node] + count
    indices, found = np.empty(indptr[-1], np.int32), np.zeros(indptr[-1])
    for node in range(nodes):
        for component in range(dimension):
            place = indptr[node]
            row = node * dimension + component
            for slot in range(rows[row], rows[row + 1]):
                if columns[slot] < nodes * dimension and columns[slot] % dimension == component:
                    indices[place] = columns[slot] // dimension
                    found[place] += data[slot] / dimension
                    place += 1
    return indptr, indices, found
