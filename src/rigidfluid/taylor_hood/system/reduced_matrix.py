"""Pᵀ K P with the bodies' masses, on one sparsity pattern for all matrices of a topology.

SciPy's products leave out what happens to be zero, so that their patterns change from step to step. Here zeros stay,
and what PARDISO has found out about the pattern serves all these matrices.
"""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.constraint import Constraint


class ReducedMatrix:
    """The pattern of Pᵀ K P, whatever the numbers in it, and the matrices on it.

    Parameters
    ----------
    constraint : Constraint
        P.
    system_matrix : sparse array
        A K of the topology; all have its pattern.
    """

    def __init__(self, constraint: Constraint, system_matrix: sparse.csr_array) -> None:
        self._constraint = constraint
        pattern = _ones(constraint.transposed) @ _ones(system_matrix) @ _ones(constraint.matrix)
        pattern = sparse.csr_array(pattern + _blocks(constraint))
        pattern.sort_indices()
        self._indptr, self._indices = pattern.indptr.astype(np.int32), pattern.indices.astype(np.int32)

    def filled(self, system_matrix: sparse.csr_array, masses: FloatArray) -> sparse.csr_array:
        """Pᵀ K P for the present P, with ``masses`` (n, d+k, d+k) of the bodies that are free on their twists."""
        constraint = self._constraint
        factors = _arrays(constraint.transposed), _arrays(system_matrix), _arrays(constraint.matrix)
        data = _entries(self._indptr, self._indices, *factors, constraint.twist_start, masses)
        return sparse.csr_array((data, self._indices, self._indptr), shape=(constraint.unknowns,) * 2)


def _arrays(matrix: sparse.csr_array) -> tuple[Any, Any, Any]:
    return matrix.indptr, matrix.indices, matrix.data


def _ones(matrix: sparse.csr_array) -> sparse.csr_array:
    """Sums of products of such do not cancel."""
    return sparse.csr_array((np.ones(matrix.nnz, dtype=np.float32), matrix.indices, matrix.indptr), shape=matrix.shape)


def _blocks(constraint: Constraint) -> sparse.csr_array:
    """Ones where a body's mass may be, on the twists of each free body."""
    d = constraint.surfaces.numbering.dimension
    width = d + (1 if d == 2 else 3)
    free = int(np.count_nonzero(~constraint.prescribed))
    twists = constraint.twist_start + np.arange(free * width).reshape(-1, width)
    place = np.repeat(twists, width, axis=1).ravel(), np.tile(twists, (1, width)).ravel()
    return sparse.coo_array((np.ones(len(place[0])), place), shape=(constraint.unknowns,) * 2).tocsr()


@njit(cache=True)
def _entries(indptr, indices, left, middle, right, first_twist, masses):
    """The product of three + masses, row by row, on the pattern given."""
    t_indptr, t_indices, t_data = left
    k_indptr, k_indices, k_data = middle
    p_indptr, p_indices, p_data = right
    data = np.zeros(len(indices))
    slot_of = np.full(len(indptr) - 1, -1)
    width = masses.shape[1]
    for row in range(len(indptr) - 1):
        first = indptr[row]
        for slot in range(first, indptr[row + 1]):
            slot_of[indices[slot]] = slot
        for t in range(t_indptr[row], t_indptr[row + 1]):
            for k in range(k_indptr[t_indices[t]], k_indptr[t_indices[t] + 1]):
                value = t_data[t] * k_data[k]
                for p in range(p_indptr[k_indices[k]], p_indptr[k_indices[k] + 1]):
                    slot = slot_of[p_indices[p]]
                    if slot >= first:  # else it is an earlier row's, and zero here
                        data[slot] += value * p_data[p]
        twist = row - first_twist
        if 0 <= twist < len(masses) * width:
            body, part = divmod(twist, width)
            for other in range(width):
                data[slot_of[first_twist + body * width + other]] += masses[body, part, other]
    return data
