"""GMRES preconditioned by the LU factors of an earlier step's matrix, in one process."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, final

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, gmres

from rigidfluid.core.ranks import ALONE
from rigidfluid.core.types import FloatArray
from rigidfluid.taylor_hood.factorization import Factors, factorise
from rigidfluid.taylor_hood.stale_solver import StaleSolver


@final
class StaleFactors(StaleSolver["sparse.csr_array"]):
    """LU by `factorise`; one costs about as much as 30 iterations (PARDISO, 15,000 to 150,000 unknowns)."""

    price: ClassVar[int] = 30
    when_fresh: ClassVar[int] = 3
    most: ClassVar[int] = 60

    def __init__(self) -> None:
        super().__init__(ALONE)
        self._factors: Factors | None = None

    def make(self, matrix: sparse.csr_array) -> None:
        self._factors = factorise(matrix)

    def drop(self) -> None:
        self._factors = None

    def iterate(
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
            restart=self.most,
            maxiter=1,
            callback=norms.append,
            callback_type="pr_norm",
        )
        return factors.solve(inner), len(norms), failed == 0
