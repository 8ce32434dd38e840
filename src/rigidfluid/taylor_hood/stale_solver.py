"""GMRES preconditioned by the LU factors of an earlier step's matrix, renewed when that pays."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres

from rigidfluid.core.types import FloatArray
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.factorization import Factors, factorise

# One factorisation costs about as much as this many iterations (PARDISO, 15,000 to 150,000 unknowns),
_ITERATIONS_PER_FACTORISATION = 30
# and with fresh factors, once the step has settled, a solve takes about this many.
_ITERATIONS_WHEN_FRESH = 3
_MOST_ITERATIONS = 60


class StaleSolver:
    """Solves A x = b for a matrix that changes little from step to step.

    The factors are renewed when the iterations beyond those that fresh factors would have taken add up to the price of
    new ones: a rule of counts, not of clock time, so that a run can be repeated to the last bit.
    """

    def __init__(self) -> None:
        self._factors: Factors | None = None
        self._solves = 0
        self._wasted = 0

    def forget(self) -> None:
        """Drop the factors."""
        self._factors = None

    def solve(
        self,
        apply: Callable[[FloatArray], FloatArray],
        matrix: Callable[[], sparse.csr_array],
        residual: FloatArray,
        tolerance: float,
    ) -> tuple[FloatArray, int]:
        """The correction x with ‖residual - A x‖ ≤ tolerance, and the iterations spent; raises StepRejected.

        ``apply(x)`` is A x; ``matrix()`` builds A where new factors are needed.
        """
        if np.linalg.norm(residual) <= tolerance:
            return np.zeros_like(residual), 0
        if self._factors is None or self._wasted > _ITERATIONS_PER_FACTORISATION:
            self._renew(matrix)
        correction, iterations, converged = self._iterate(apply, residual, tolerance)
        if not converged and self._solves > 0:
            self._renew(matrix)
            correction, iterations, converged = self._iterate(apply, residual, tolerance)
        if not converged:
            raise StepRejected(
                "fluid.tolerance",
                f"a linear system that does not converge to {tolerance:.1e} in {_MOST_ITERATIONS} iterations",
                "a converging one",
                "Shorten time.step or loosen fluid.tolerance.",
            )
        self._solves += 1
        self._wasted += max(0, iterations - _ITERATIONS_WHEN_FRESH)
        return correction, iterations

    def _renew(self, matrix: Callable[[], sparse.csr_array]) -> None:
        self._factors = None  # frees the old factors before the new ones need memory
        self._factors = factorise(matrix())
        self._solves = self._wasted = 0

    def _iterate(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray, tolerance: float
    ) -> tuple[FloatArray, int, bool]:
        """Preconditioned on the right, so that the norm that stops the iteration is the true residual's."""
        assert self._factors is not None
        factors = self._factors
        norms: list[float] = []
        operator = LinearOperator((len(residual),) * 2, matvec=lambda y: apply(factors.solve(y)), dtype=np.float64)
        inner, failed = gmres(
            operator,
            residual,
            rtol=0.0,
            atol=tolerance,
            restart=_MOST_ITERATIONS,
            maxiter=1,
            callback=norms.append,
            callback_type="pr_norm",
        )
        return factors.solve(inner), len(norms), failed == 0
