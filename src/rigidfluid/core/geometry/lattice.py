"""Lattice of displacements between periodic surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Lattice:
    """Displacements Σ c_i v_i, c_i whole, by ``vectors`` v (k, d) at right angles to each other; its cell c has the
    points x with c_i ≤ (x - ``origin``)·v_i/|v_i|² < c_i + 1 [length]."""

    vectors: FloatArray
    origin: FloatArray

    @property
    def lengths(self) -> FloatArray:
        """Lengths of the vectors, (k,) [length]."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1))

    @property
    def shortest(self) -> float:
        """Length of the shortest vector, infinite without any [length]."""
        return float(self.lengths.min(initial=np.inf))

    def components(self, differences: FloatArray) -> FloatArray:
        """Components d·v_i/|v_i|² of ``differences`` (…, d), (…, k) [1]."""
        return np.asarray(differences @ (self.vectors / self.lengths[:, None] ** 2).T)

    def coordinates(self, points: FloatArray) -> FloatArray:
        """Coordinates (x - x₀)·v_i/|v_i|² of ``points`` (N, d), (N, k) [1]."""
        return self.components(points - self.origin)

    def cells(self, points: FloatArray) -> IntArray:
        """Cells of ``points`` (N, d), (N, k)."""
        return np.floor(self.coordinates(points)).astype(np.int64)

    def displacement(self, cells: IntArray) -> FloatArray:
        """Displacements of ``cells`` (…, k) from the first one, (…, d) [length]."""
        return np.asarray(cells @ self.vectors)

    def shortened(self, differences: FloatArray) -> FloatArray:
        """Shortest images of ``differences`` (…, d) of points, (…, d) [length]."""
        return differences - self.displacement(np.rint(self.components(differences)).astype(np.int64))

    def wrapped(self, points: FloatArray) -> FloatArray:
        """Images of ``points`` (N, d) in the first cell, (N, d) [length]."""
        return points - self.displacement(self.cells(points))
