"""Products of PETSc's matrices."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc


def projected(matrix: Any, basis: Any, before: Any = None) -> Any:
    """Product basisᵀ matrix basis, written into ``before``, an earlier one with the same sparsity, if there is one.

    It is formed by two products, as PETSc's PtAP takes seconds where a row is long, and a body's row has all nodes on
    the body. The result is a copy, since a product holds its factors as long as it lives.
    """
    image = matrix.matMult(basis)
    product = basis.transposeMatMult(image)
    found = product.copy(before, structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    for held in (product, image):
        held.destroy()
    return found
