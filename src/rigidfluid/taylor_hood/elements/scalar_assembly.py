"""Interface of the integrals that a transported scalar needs."""

from __future__ import annotations

from typing import Protocol

from scipy import sparse

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.elements.numbering import Numbering


class ScalarAssembly(Protocol):
    """Integrals over the cells of one topology that the scalar needs."""

    numbering: Numbering

    def scalar_matrix(
        self, points: FloatArray, inertia: float, diffusivity: float, flow: FloatArray
    ) -> sparse.csr_array:
        """Matrix of inertia (T, v) - (c T, ∇v) + diffusivity (∇T, ∇v), with the ``flow`` c (nodes, d)."""

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function, (nodes, d)."""
