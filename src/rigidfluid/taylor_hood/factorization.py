"""LU factors of one sparse matrix, by MKL's PARDISO where it is installed and SciPy's SuperLU elsewhere."""

from __future__ import annotations

import copy
import ctypes
import functools
import importlib.util
import os
import weakref
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.mkl import installed_mkl

_ANALYSE_AND_FACTORISE, _FACTORISE, _SOLVE = 12, 22, 33
_SAME_BITS = 2  # MKL_CBWR_AUTO


def _pardiso_settings(pivots: int, matching: int) -> NDArray[np.int32]:
    """PARDISO's iparm; no iterative refinement, which the Krylov iteration around the factors does better."""
    given, nested_dissection = 1, 2
    iparm = np.zeros(64, dtype=np.int32)
    iparm[[0, 1, 9, 10, 12]] = given, nested_dissection, pivots, matching, matching
    return iparm


_PERTURBED_PIVOTS = 13
# Scaled and matched first: most often exact. Where a pivot had to be replaced by 1e-13, the factors may be worthless;
# without matching, and with 1e-8 in the place of small pivots, they make a preconditioner that serves.
_EXACT, _SAFE = _pardiso_settings(13, 1), _pardiso_settings(8, 0)
_WORTHLESS = 1e-6
"""Relative residual of a solution by factors with perturbed pivots, from which on they are not used."""


class Factors(Protocol):
    """Something that solves A x = b, of one right side or of many (N, c), for the matrix that it was made from."""

    @property
    def reusable(self) -> bool:
        """Whether `factorise` can start from them."""

    def solve(self, right_side: FloatArray) -> FloatArray: ...


@functools.cache
def _library() -> Any:
    """The loaded MKL, told to answer the same question with the same bits (conditional numerical reproducibility).

    pypardiso searches the whole disk for it each time a solver is made, .3 s of work, unless a variable names it.
    """
    if (path := installed_mkl()) is not None:
        os.environ.setdefault("PYPARDISO_MKL_RT", str(path))
    from pypardiso.pardiso_wrapper import PyPardisoSolver

    solver = PyPardisoSolver()
    solver.libmkl.MKL_CBWR_Set(ctypes.c_int(_SAME_BITS))
    return solver


class _Pardiso:
    """pypardiso's solve() compares the whole matrix at every call; the solve phase alone is what we call here."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._matrix = matrix
        self.reusable = True
        self._analyse(_EXACT)
        if self._solver.iparm[_PERTURBED_PIVOTS] > 0 and self._residual() > _WORTHLESS:
            self.free()
            self._analyse(_SAFE)
            self.reusable = False  # the next matrix may do with the exact ones

    def renewed(self, matrix: sparse.csr_array) -> bool:
        """Factorise another matrix by the analysis at hand; False where it serves another pattern, or badly.

        Scaling and matching are those of the matrix analysed, so that the factors are always tried.
        """
        if not self.reusable or not _same_pattern(matrix, self._matrix):
            return False
        self._matrix = matrix
        try:
            _run(self._solver, _FACTORISE, matrix)
        except StepRejected:
            return False
        return self._residual() <= _WORTHLESS

    def free(self) -> None:
        """Give PARDISO's memory back, the analysis too."""
        self._finalizer()

    def solve(self, right_side: FloatArray) -> FloatArray:
        solution: FloatArray = self._solver._call_pardiso(self._matrix, np.asfortranarray(right_side))
        return solution

    def _analyse(self, settings: NDArray[np.int32]) -> None:
        self._solver = copy.copy(_library())
        self._solver.pt = np.zeros_like(self._solver.pt)
        self._solver.iparm = settings.copy()
        self._finalizer = weakref.finalize(self, self._solver.free_memory, everything=True)
        _run(self._solver, _ANALYSE_AND_FACTORISE, self._matrix)

    def _residual(self) -> float:
        right_side = self._matrix @ np.ones(self._matrix.shape[0])
        left = right_side - self._matrix @ self.solve(right_side)
        return float(np.linalg.norm(left) / np.linalg.norm(right_side))


def _run(solver: Any, phase: int, matrix: sparse.csr_array) -> None:
    """Run a phase, and be ready to solve."""
    from pypardiso.pardiso_wrapper import PyPardisoError

    solver.set_phase(phase)
    try:
        solver._call_pardiso(matrix, np.zeros(matrix.shape[0]))
    except PyPardisoError as error:
        raise _singular(matrix, error) from error
    solver.set_phase(_SOLVE)


def _same_pattern(one: sparse.csr_array, other: sparse.csr_array) -> bool:
    return np.array_equal(one.indptr, other.indptr) and np.array_equal(one.indices, other.indices)


class _SuperLU:
    reusable = False

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


def factorise(matrix: sparse.csr_array, before: Factors | None = None) -> Factors:
    """Factorise a regular matrix; raises StepRejected where it is singular.

    The factors ``before`` are used up: where they are of the same pattern, PARDISO does not analyse it again.
    """
    matrix.sort_indices()
    if not importlib.util.find_spec("pypardiso"):
        return _SuperLU(matrix)
    if isinstance(before, _Pardiso):
        if before.renewed(matrix):
            return before
        before.free()
    return _Pardiso(matrix)
