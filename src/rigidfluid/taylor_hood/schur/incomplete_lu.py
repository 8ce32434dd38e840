"""Incomplete LU factors without fill, ILU(0), that serve several right sides at once."""

# numba compiles for the types that come; annotations would be a second, unchecked signature.
# mypy: disallow-untyped-defs=False

from __future__ import annotations

import numpy as np
from numba import njit
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray


class IncompleteLU:
    """L U on the pattern of A, equal to A there, in single precision.

    Parameters
    ----------
    matrix : csr_array
        A, with sorted indices and a diagonal without zeros.
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._rows, self._columns = matrix.indptr, matrix.indices
        data = matrix.data.copy()
        self._diagonal = _factorise(self._rows, self._columns, data)
        self._data = data.astype(np.float32)

    def solve(self, right_sides: FloatArray) -> FloatArray:
        """(L U)⁻¹ ``right_sides`` (N, c)."""
        found = right_sides.copy()
        _solve(self._rows, self._columns, self._data, self._diagonal, found, tuple(range(found.shape[1])))
        return found


@njit(cache=True)
def _factorise(rows, columns, data):
    """Overwrite A by its factors, the diagonal of U by its inverse; return the places of the diagonal."""
    size = len(rows) - 1
    diagonal, slot_of = np.empty(size, np.int64), np.full(size, -1)
    for row in range(size):
        first, last = rows[row], rows[row + 1]
        for slot in range(first, last):
            slot_of[columns[slot]] = slot
        diagonal[row] = slot_of[row]
        for slot in range(first, diagonal[row]):
            pivot = columns[slot]
            factor = data[slot] * data[diagonal[pivot]]
            data[slot] = factor
            for other in range(diagonal[pivot] + 1, rows[pivot + 1]):
                place = slot_of[columns[other]]
                if place >= first:  # else it is an earlier row's, and fill here
                    data[place] -= factor * data[other]
        data[diagonal[row]] = 1.0 / data[diagonal[row]]
    return diagonal


@njit(cache=True)
def _solve(rows, columns, data, diagonal, x, sides):
    """Overwrite x (N, c) by U⁻¹ L⁻¹ x."""
    size = len(rows) - 1
    for row in range(size):
        for slot in range(rows[row], diagonal[row]):
            column, entry = columns[slot], data[slot]
            for side in range(len(sides)):
                x[row, side] -= entry * x[column, side]
    for row in range(size - 1, -1, -1):
        for slot in range(diagonal[row] + 1, rows[row + 1]):
            column, entry = columns[slot], data[slot]
            for side in range(len(sides)):
                x[row, side] -= entry * x[column, side]
        for side in range(len(sides)):
            x[row, side] *= data[diagonal[row]]
