"""SciPy's flexible GCROT with a count of its iterations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse.linalg import LinearOperator, gcrotmk

from rigidfluid.core.geometry.arrays import FloatArray


def flexible_gmres(
    apply: Callable[[FloatArray], FloatArray],
    precondition: Callable[[FloatArray], FloatArray],
    residual: FloatArray,
    tolerance: float,
    most: int,
    cycles: int,
) -> tuple[FloatArray, int, bool]:
    """x with ‖residual - A x‖ ≤ tolerance, the iterations spent, and whether it was reached in ``most``.

    Preconditioned on the right, so that the norm that stops the iteration is the true residual's. The inner iteration
    keeps what ``precondition`` gave, so that an iteration takes one of it and the end none. One of ``cycles`` that
    misses by round-off is followed by another.
    """
    solves = 0

    def counted(vector: FloatArray) -> FloatArray:
        nonlocal solves
        solves += 1
        return precondition(vector)

    shape = (len(residual),) * 2
    correction, failed = gcrotmk(
        LinearOperator(shape, matvec=apply, dtype=np.float64),
        residual,
        rtol=0.0,
        atol=tolerance,
        M=LinearOperator(shape, matvec=counted, dtype=np.float64),
        m=most // cycles,
        k=1,
        maxiter=cycles,
    )
    if failed:  # or not judged: the last cycle
        failed = float(np.linalg.norm(residual - apply(correction))) > tolerance
    return correction, solves, not failed
