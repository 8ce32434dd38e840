"""Conduction of a scalar inside a body, in the body's own frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Inside:
    """Cells inside a body, in its frame: ``points`` (N, d) [length], ``cells`` (M, d+1), and the edges that are curved,
    as pairs of points (K, 2) with their ``middles`` (K, d) [length]."""

    points: FloatArray
    cells: IntArray
    curved: IntArray
    middles: FloatArray

    @property
    def geometry(self) -> FloatArray:
        """The points, then the middles of curved edges, (N + K, d) [length]."""
        return np.concatenate([self.points, self.middles])


@dataclass(frozen=True, eq=False)
class Conduction:
    """Conduction in a body: c ∂T/∂t = ∇·(kκ∇T), κ being the fluid's diffusivity.

    ``conductivity`` k over the fluid's [1]; ``capacity`` of the whole body, c times its volume [length^d]. ``inside``
    gives its cells, the same record for bodies of one shape; raises MeshError.
    """

    conductivity: float
    capacity: float
    inside: Callable[[], Inside]
