"""Products of PETSc's matrices."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc


def projected(matrix: Any, basis: Any, before: Any = None) -> Any:
    """basisᵀ matrix basis, in the place of one that was made ``before`` with the same patterns, if there is one.

    Two products serve: PETSc's PtAP takes seconds where a row is long, as a body's is, which joins all nodes on it. The
    result is a copy, since a product holds its factors as long as it lives.
    """
    image = matrix.matMult(basis)
    product = basis.transposeMatMult(image)
    found = product.copy(before, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    for held in (product, image):
        held.destroy()
    return found
