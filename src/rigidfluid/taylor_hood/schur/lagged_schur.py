"""Flexible GMRES preconditioned by the block triangle of an earlier step's matrix, in one process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import ClassVar, final

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.ranks import ALONE
from rigidfluid.taylor_hood.linear_solver.flexible_gmres import flexible_gmres
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver
from rigidfluid.taylor_hood.schur.block_triangle import BlockTriangle
from rigidfluid.taylor_hood.schur.films import Films
from rigidfluid.taylor_hood.system.parts import Parts


@final
class LaggedSchur(LaggedSolver[Parts]):
    """Solver preconditioned by a `BlockTriangle`, whose memory and cost grow in proportion to the unknowns."""

    rebuild_cost: ClassVar[Mapping[int, int]] = {2: 12, 3: 12}
    fresh_iterations: ClassVar[int] = 20
    most: ClassVar[int] = 200
    sharper: ClassVar[float] = 1e-2  # factors leave far less than they are asked for, this leaves a slow error

    def __init__(self, dimension: int) -> None:
        super().__init__(ALONE, dimension)
        self._triangle: BlockTriangle | None = None
        self._films: Films | None = None

    def make(self, matrix: Parts) -> None:
        self._triangle, self._films = BlockTriangle(matrix), Films(matrix)

    def drop(self) -> None:
        self._triangle = self._films = None

    def iterate(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray, tolerance: float, most: int
    ) -> tuple[FloatArray, int, bool]:
        return flexible_gmres(apply, self._precondition, residual, tolerance, most, 2)

    def _precondition(self, right_side: FloatArray) -> FloatArray:
        assert self._triangle is not None
        assert self._films is not None
        found = self._triangle.solve(right_side)
        self._films.correct(found, right_side)
        return found
