"""Extends a field that is given at some vertices of a mesh to all of them."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.sparse import csc_array

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray


class Extension(Protocol):
    """Solves A_ff u_f = -A_fh u_h, f the free vertices and h those where u is given."""

    def fill(self, values: FloatArray) -> None:
        """Overwrite the free entries of ``values`` (N,)."""


class FactorisedExtension:
    """Extension by factors of A_ff, made once from a symmetric stiffness ``matrix`` (N, N); at least one value is
    ``held``, (N,)."""

    def __init__(self, matrix: csc_array, held: BoolArray) -> None:
        from scipy.sparse.linalg import splu

        self._held, self._free = np.flatnonzero(held), np.flatnonzero(~held)
        rows = matrix.tocsr()[self._free].tocsc()
        self._coupling = rows[:, self._held].tocsr()
        self._factor = splu(rows[:, self._free], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})

    def fill(self, values: FloatArray) -> None:
        values[self._free] = self._factor.solve(-(self._coupling @ values[self._held]))
