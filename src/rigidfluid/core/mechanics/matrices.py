"""Matrices on the velocities of all bodies: arrays where these are few, sparse for many."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray, IntArray

MOST_FULL = 64
"""Largest number of columns of an array; a sparse matrix is faster for more."""


def assembled(entries: FloatArray, rows: IntArray, columns: IntArray, shape: tuple[int, int]) -> Any:
    """Matrix of this ``shape`` with the sums of the ``entries`` at their ``rows`` and ``columns``, all flat."""
    if shape[1] > MOST_FULL:
        return sparse.csr_matrix((entries, (rows, columns)), shape)
    return np.bincount(shape[1] * rows + columns, entries, shape[0] * shape[1]).reshape(shape)


def sparse_as(other: Any, matrix: FloatArray) -> Any:
    """The ``matrix``, sparse where the ``other`` one is."""
    return matrix if isinstance(other, np.ndarray) else sparse.csr_matrix(matrix)


def full(matrix: Any) -> FloatArray:
    """The ``matrix`` as an array."""
    return matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray())
