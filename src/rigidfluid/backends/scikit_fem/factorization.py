"""LU factors of one sparse matrix, by MKL's PARDISO where it is installed and SciPy's SuperLU elsewhere."""

from __future__ import annotations

import importlib.util
import weakref
from typing import Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.types import FloatArray
from rigidfluid.errors import StepRejected

_ANALYSE_AND_FACTORISE, _SOLVE = 12, 33


class Factors(Protocol):
    """Something that solves A x = b for the matrix that it was made from."""

    def solve(self, right_side: FloatArray) -> FloatArray: ...


class _Pardiso:
    """pypardiso's solve() compares the whole matrix at every call; the solve phase alone is what we call here."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        from pypardiso.pardiso_wrapper import PyPardisoError, PyPardisoSolver

        self._matrix = matrix
        self._solver = PyPardisoSolver()
        self._solver.set_phase(_ANALYSE_AND_FACTORISE)
        try:
            self._solver._call_pardiso(matrix, np.zeros(matrix.shape[0]))
        except PyPardisoError as error:
            raise _singular(matrix, error) from error
        self._solver.set_phase(_SOLVE)
        weakref.finalize(self, self._solver.free_memory, everything=True)

    def solve(self, right_side: FloatArray) -> FloatArray:
        solution: FloatArray = self._solver._call_pardiso(self._matrix, right_side)
        return solution


class _SuperLU:
    def __init__(self, matrix: sparse.csr_array) -> None:
        from scipy.sparse.linalg import splu

        try:
            self._factors = splu(matrix.tocsc())
        except RuntimeError as error:
            raise _singular(matrix, error) from error

    def solve(self, right_side: FloatArray) -> FloatArray:
        return self._factors.solve(right_side)


def _singular(matrix: sparse.csr_array, error: Exception) -> StepRejected:
    return StepRejected(
        "fluid.backend",
        f"a matrix of {matrix.shape[0]} unknowns that cannot be factorised ({error})",
        "a regular matrix",
        "Shorten time.step, or look at the mesh near the bodies.",
    )


def factorise(matrix: sparse.csr_array) -> Factors:
    """Factorise a regular matrix; raises StepRejected where it is singular."""
    matrix.sort_indices()
    if importlib.util.find_spec("pypardiso"):
        return _Pardiso(matrix)
    return _SuperLU(matrix)
