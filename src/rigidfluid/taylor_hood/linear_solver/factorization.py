"""LU factors of one sparse matrix, by MKL's PARDISO where it is installed and SciPy's SuperLU elsewhere.

They precondition a Krylov iteration: single precision is enough.
"""

from __future__ import annotations

import importlib.util
from typing import Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver.pardiso import EXACT, FAST, SAFE, Orderings, Pardiso, PardisoError

_WORTHLESS = 1e-3
"""Relative residual of a known solution, from which on factors are not used."""

_MISSED = 0.1
"""Error of a known solution of ones, from which on factors in single precision are not used: in films thinner than a
thousandth of a radius another flow leaves the same residual."""


class Factors(Protocol):
    """Something that solves A x = b, of one right side or of many (N, c), for the matrix that it was made from."""

    @property
    def reusable(self) -> bool:
        """Tell whether `factorise` can start from them."""

    @property
    def rebuild_cost(self) -> int | None:
        """Cost of factors for another matrix of the same pattern, in iterations; None where it is not known."""

    def solve(self, right_side: FloatArray) -> FloatArray: ...


class _SuperLU:
    reusable, rebuild_cost = False, None

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


def factorise(matrix: sparse.csr_array, before: Factors | None = None, orderings: Orderings | None = None) -> Factors:
    """Factorise a regular matrix; raises StepRejected where it is singular.

    The factors ``before`` are used up: where they are of the same pattern, PARDISO does not analyse it again. Else the
    order of elimination is taken from ``orderings``, if it is there.
    """
    matrix.sort_indices()
    if not importlib.util.find_spec("pypardiso"):
        return _SuperLU(matrix)
    analysed = None
    if isinstance(before, Pardiso):
        if before.reusable and before.has_pattern_of(matrix):
            analysed = before
        else:
            before.free()
    return _pardiso_factors(matrix, analysed, orderings or Orderings())


def _pardiso_factors(matrix: sparse.csr_array, analysed: Pardiso | None, orderings: Orderings) -> Pardiso:
    """Factors by the first of PARDISO's settings that serves; those of the last are not tested: there is no other."""
    for settings in (FAST, EXACT, SAFE):
        try:
            factors, analysed = analysed or Pardiso(matrix, settings, orderings), None
            factors.factorise(matrix)
            if settings is SAFE or _serves(factors, matrix):
                return factors
        except PardisoError as error:
            if settings is SAFE:
                raise _singular(matrix, error) from error
    raise AssertionError("the last settings return or raise")


def _serves(factors: Pardiso, matrix: sparse.csr_array) -> bool:
    """Tell whether the factors find a known solution, all ones: by its residual, in single precision by its error."""
    right_side = matrix @ np.ones(matrix.shape[0])
    found = factors.solve(right_side)
    residual = float(np.linalg.norm(right_side - matrix @ found) / np.linalg.norm(right_side))
    if not residual <= _WORTHLESS:
        return False
    return factors.settings is not FAST or bool(np.abs(found - 1.0).max() <= _MISSED)
