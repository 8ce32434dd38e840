"""A linear system that is solved once, with a matrix of which nothing is kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver.factorization import factorise
from rigidfluid.taylor_hood.linear_solver.flexible_gmres import flexible_gmres
from rigidfluid.taylor_hood.schur.incomplete_lu import IncompleteLU

_ENOUGH, _MOST = 1e3, 120
"""Residual over the tolerance that is let pass where rounding keeps from it, and iterations with each kind of
factors."""


def solved_once(matrix: sparse.csr_array, residual: FloatArray, tolerance: float) -> FloatArray:
    """x with ‖residual - A x‖ ≤ tolerance, by incomplete factors, and by complete ones where these do not do."""
    found = np.zeros_like(residual)
    for make in (_incomplete, _complete):
        left = residual - matrix @ found
        if float(np.linalg.norm(left)) <= tolerance:
            return found
        correction, _, converged = flexible_gmres(matrix.__matmul__, make(matrix), left, tolerance, _MOST, cycles=2)
        found = found + correction
        if converged:
            return found
    if not float(np.linalg.norm(residual - matrix @ found)) <= _ENOUGH * tolerance:
        shown = f"a linear system that does not converge to {_ENOUGH * tolerance:.1e}"
        raise StepRejected("the scalar", shown, "a converging one", "Shorten time.step.")
    return found


def _incomplete(matrix: sparse.csr_array) -> Callable[[FloatArray], FloatArray]:
    """Approximate inverse by ILU(0), which is cheap to make anew in each step."""
    matrix.sort_indices()
    factors = IncompleteLU(matrix)
    return lambda vector: factors.solve(vector[:, None])[:, 0]


def _complete(matrix: sparse.csr_array) -> Callable[[FloatArray], FloatArray]:
    return factorise(matrix).solve
