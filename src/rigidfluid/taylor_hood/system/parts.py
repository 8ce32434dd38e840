"""Ingredients of a preconditioner of the coupled matrix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.coefficients import Coefficients
from rigidfluid.taylor_hood.system.constraint import Constraint


@dataclass(frozen=True, eq=False)
class Parts:
    """Parts of the matrix Pᵀ K P + masses: K ``system_matrix``, P of the ``constraint``, ``masses`` (n, d+k, d+k) of
    the free motions.

    ``points`` (vertices, d) of the mesh; the ``coefficients`` in K; ``reduced()``: the matrix itself.
    """

    constraint: Constraint
    system_matrix: sparse.csr_array
    masses: FloatArray
    points: FloatArray
    coefficients: Coefficients
    reduced: Callable[[], sparse.csr_array]
