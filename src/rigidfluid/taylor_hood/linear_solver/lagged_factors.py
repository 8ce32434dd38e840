"""Flexible GMRES preconditioned by the LU factors of an earlier step's matrix, in one process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import ClassVar, final

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.ranks import ALONE
from rigidfluid.taylor_hood.linear_solver.factorization import Factors, factorise
from rigidfluid.taylor_hood.linear_solver.flexible_gmres import flexible_gmres
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver
from rigidfluid.taylor_hood.linear_solver.pardiso import Orderings
from rigidfluid.taylor_hood.system.parts import Parts

_LEAST = float(np.finfo(float).tiny)
"""Tolerance in place of zero, that of a right side of zero."""


@final
class LaggedFactors(LaggedSolver[Parts]):
    """Solver preconditioned by LU factors of `factorise`.

    PARDISO's factors know their rebuild_cost; that of others is what SuperLU, which analyses each time, took.
    """

    rebuild_cost: ClassVar[Mapping[int, int]] = {2: 30, 3: 100}
    fresh_iterations: ClassVar[int] = 1
    most: ClassVar[int] = 40

    most_sweeps: ClassVar[int] = 6
    """Greatest number of sweeps over all columns together; factors that need more are worth renewing."""

    def __init__(self, dimension: int, orderings: Orderings | None = None) -> None:
        super().__init__(ALONE, dimension)
        self._orderings = orderings or Orderings()
        self._factors: Factors | None = None

    def make(self, matrix: Parts) -> None:
        before, self._factors = self._factors, None
        self._factors = factorise(matrix.reduced(), before, self._orderings)
        self._rebuild_cost = self._factors.rebuild_cost or self._rebuild_cost

    def make_room(self) -> None:
        if self._factors is not None and not self._factors.reusable:
            self._factors = None

    def drop(self) -> None:
        self._factors = None

    def iterate(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray, tolerance: float, most: int
    ) -> tuple[FloatArray, int, bool]:
        assert self._factors is not None
        cycles = 2 if most == self.most else 1
        return flexible_gmres(apply, self._factors.solve, residual, tolerance, most, cycles)

    def iterate_columns(
        self, apply: Callable[[FloatArray], FloatArray], right_sides: FloatArray, enough: FloatArray
    ) -> tuple[FloatArray | None, int]:
        """Minimise each column's residual along F⁻¹ times what is left, made conjugate to the direction before: the
        factors serve many columns at once at a quarter of the price of one by one."""
        assert self._factors is not None
        enough = np.maximum(enough, _LEAST)
        found, left, before = np.zeros_like(right_sides), right_sides, None
        least, rebuild_cost = _greatest(left, enough), max(1, right_sides.shape[1] // 4)
        for sweep in range(self.most_sweeps):
            if least <= 1.0:
                return found, rebuild_cost * max(0, sweep - 1)
            direction = self._factors.solve(left)
            image = np.asfortranarray(apply(direction))  # as the factors' answers are, for sums over columns
            if before is not None:
                along = _shares(image, before[1])
                direction, image = direction - along * before[0], image - along * before[1]
            along = _shares(left, image)
            found, left, before = found + along * direction, left - along * image, (direction, image)
            rest = _greatest(left, enough)
            least, rate = rest, rest / least
            if rate ** (self.most_sweeps - sweep) * rest > 1.0 and sweep > 0:
                break
        return (found if least <= 1.0 else None), rebuild_cost * (self.most_sweeps - 1)


def _greatest(columns: FloatArray, enough: FloatArray) -> float:
    """Greatest norm of the ``columns`` (N, c) over what is ``enough`` (c,) [1]."""
    return float(np.max(np.linalg.norm(columns, axis=0) / enough, initial=0.0))


def _shares(columns: FloatArray, directions: FloatArray) -> FloatArray:
    """Multiples (c,) of the ``directions`` (N, c) that are nearest to the ``columns`` (N, c), zero of directions that
    are zero."""
    product, square = (np.einsum("nc,nc->c", each, directions) for each in (columns, directions))
    return np.asarray(product / np.maximum(square, _LEAST))
