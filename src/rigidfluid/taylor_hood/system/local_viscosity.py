"""Varying part of a fluid's viscosity, at the points by which viscous stress is integrated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray

_PREFIX = "local_"
_NAMES = ("relative", "slope", "direction", "of_cells")


@dataclass(frozen=True, eq=False)
class StrainRates:
    """∇u + ∇uᵀ ``tensor`` (N, d, d) [1/time] at quadrature points of the ``cell`` (N,), with the ``weight`` (N,) of
    each in integrals over the mesh [length^d]."""

    tensor: FloatArray
    weight: FloatArray
    cell: IntArray

    @property
    def shear_rate(self) -> FloatArray:
        """γ̇ = √(½|∇u + ∇uᵀ|²), (N,) [1/time]."""
        return np.asarray(np.sqrt(0.5 * np.einsum("nac,nac->n", self.tensor, self.tensor)))

    def cell_means(self, values: FloatArray) -> FloatArray:
        """Mean of ``values`` (N,) in each cell, (M,)."""
        volume = np.bincount(self.cell, self.weight)
        return np.asarray(np.bincount(self.cell, self.weight * values) / volume)


@dataclass(frozen=True, eq=False)
class LocalViscosity:
    """Viscosity at quadrature points over the constant one of a matrix: ``relative`` (N,), its derivative ``slope``
    (N,) by log γ̇ and the ``direction`` (N, d, d) of the strain rate, (∇u + ∇uᵀ)/γ̇; ``of_cells`` (M,), their means.

    The stress of w is then relative · (∇w + ∇wᵀ) + slope · (direction:∇w) direction.
    """

    relative: FloatArray
    slope: FloatArray
    direction: FloatArray
    of_cells: FloatArray

    @property
    def varies(self) -> bool:
        """Tell whether it is not 1 everywhere."""
        return self.relative.size > 0

    def memory(self) -> dict[str, FloatArray]:
        """Arrays from which it is `recalled`; none where it does not vary."""
        return {f"{_PREFIX}{name}": getattr(self, name) for name in _NAMES} if self.varies else {}

    @classmethod
    def recalled(cls, memory: Mapping[str, FloatArray]) -> LocalViscosity:
        """Local viscosity that gave this `memory`."""
        return cls(*(memory[f"{_PREFIX}{name}"] for name in _NAMES)) if cls.is_in(memory) else UNIFORM

    @staticmethod
    def is_in(memory: Mapping[str, FloatArray]) -> bool:
        """Tell whether a `memory` has one that varies."""
        return any(name.startswith(_PREFIX) for name in memory)

    @staticmethod
    def shapes(points: int, cells: int, dimension: int) -> dict[str, tuple[int, ...]]:
        """Shapes of the arrays of a `memory`."""
        shapes = (points,), (points,), (points, dimension, dimension), (cells,)
        return {f"{_PREFIX}{name}": shape for name, shape in zip(_NAMES, shapes, strict=True)}


UNIFORM = LocalViscosity(np.empty(0), np.empty(0), np.empty((0, 0, 0)), np.ones(1))
"""A viscosity that does not vary."""
