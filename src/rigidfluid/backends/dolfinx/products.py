"""Products of PETSc's matrices."""

from __future__ import annotations

from typing import Any


def projected(matrix: Any, basis: Any, before: Any = None) -> Any:
    """basisᵀ matrix basis, in the place of one that was made ``before`` with the same patterns, if there is one.

    By two products: PETSc's PtAP takes seconds where a row is long, as a body's is, which joins all nodes on it.
    """
    image = matrix.matMult(basis)
    found = basis.transposeMatMult(image, result=before)
    image.destroy()
    return found
