"""A Krylov iteration preconditioned by what an earlier step's matrix gave, which is renewed when that pays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from typing import ClassVar, Generic, TypeVar, final

import numpy as np

from rigidfluid.core.model.ranks import Ranks
from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import StepRejected

Matrix = TypeVar("Matrix")


class LaggedSolver(ABC, Generic[Matrix]):
    """Solves A x = b for a matrix that changes little from step to step.

    The preconditioner is renewed when the iterations beyond those that a fresh one would have taken add up to the cost
    of a new one: a rule of counts, not of clock time, so that a run can be repeated to the last bit.

    ``rebuild_cost`` of a preconditioner in iterations by dimension; ``fresh_iterations``, that a solve then takes; and
    the ``most`` that may be spent on one. An old one is given up when it has wasted that cost twice.
    """

    rebuild_cost: ClassVar[Mapping[int, int]]
    fresh_iterations: ClassVar[int]
    most: ClassVar[int]

    def __init__(self, ranks: Ranks, dimension: int) -> None:
        self._ranks = ranks
        self._rebuild_cost = self.rebuild_cost[dimension]
        self._wasted = 0
        self._is_made = False

    @final
    def forget(self) -> None:
        """Drop the preconditioner."""
        self._is_made = False
        self.drop()

    @final
    def solve(
        self,
        apply: Callable[[FloatArray], FloatArray],
        matrix: Callable[[], Matrix],
        residual: FloatArray,
        tolerance: float,
    ) -> tuple[FloatArray, int]:
        """The correction x with ‖residual - A x‖ ≤ tolerance, and the iterations spent; raises StepRejected.

        ``apply(x)`` is A x; ``matrix()`` builds A where a new preconditioner is needed. Vectors are this process' part.
        """
        start = self.norm(residual)
        if not np.isfinite(start):
            raise StepRejected("fluid", f"a residual of {start}", "finite numbers", "Shorten time.step.")
        if start <= tolerance:
            return np.zeros_like(residual), 0
        fresh = not self._is_made or self._wasted > self._rebuild_cost
        if fresh:
            self._renew(matrix)
        most = self.most if fresh else min(self.most, self.fresh_iterations + 2 * self._rebuild_cost)
        correction, iterations, converged = self.iterate(apply, residual, tolerance, most)
        if not converged and not fresh:
            self._renew(matrix)
            correction, iterations, converged = self.iterate(apply, residual, tolerance, self.most)
        if not converged:
            self.forget()  # the next step tried is another one
            raise StepRejected(
                "fluid.tolerance",
                f"a linear system that does not converge to {tolerance:.1e} in {self.most} iterations",
                "a converging one",
                "Shorten time.step or loosen fluid.tolerance.",
            )
        self._wasted += max(0, iterations - self.fresh_iterations)
        return correction, iterations

    @final
    def solve_columns(
        self,
        apply: Callable[[FloatArray], FloatArray],
        matrix: Callable[[], Matrix],
        right_sides: FloatArray,
        tolerance: float,
    ) -> FloatArray:
        """x with A x = each column of ``right_sides`` (N, c), to ``tolerance`` times its norm; raises StepRejected.

        What old factors waste counts like that of a step.
        """
        fresh = not self._is_made
        if fresh:
            self._renew(matrix)
        found, wasted = self.iterate_columns(apply, right_sides, tolerance)
        if found is None and not fresh:
            self._renew(matrix)
            found, wasted = self.iterate_columns(apply, right_sides, tolerance)
        self._wasted += wasted
        if found is None:
            self.forget()
            raise StepRejected(
                "fluid.backend",
                f"answers to impulses that do not converge to {tolerance:.1e}",
                "converging ones",
                "Shorten time.step, or look at the mesh near the bodies.",
            )
        return found

    @final
    def norm(self, vector: FloatArray) -> float:
        """Its Euclidean norm, over all processes."""
        return float(np.sqrt(self._ranks.sum(vector @ vector)))

    @abstractmethod
    def make(self, matrix: Matrix) -> None:
        """Make a preconditioner of this matrix."""

    @abstractmethod
    def drop(self) -> None:
        """Free its memory."""

    def make_room(self) -> None:
        """Free what `make` will not use again, before its matrix needs memory."""
        self.drop()

    @abstractmethod
    def iterate(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray, tolerance: float, most: int
    ) -> tuple[FloatArray, int, bool]:
        """The correction, the iterations spent, at ``most``, and whether ‖residual - A x‖ ≤ tolerance was reached."""

    def iterate_columns(
        self, apply: Callable[[FloatArray], FloatArray], right_sides: FloatArray, tolerance: float
    ) -> tuple[FloatArray | None, int]:
        """The solutions (N, c), or None where one was not reached, and the iterations that fresh factors would save."""
        found, wasted = np.zeros_like(right_sides), 0
        for column in range(right_sides.shape[1]):
            right_side = right_sides[:, column]
            enough = tolerance * self.norm(right_side)
            if enough == 0.0:
                continue
            found[:, column], iterations, converged = self.iterate(apply, right_side, enough, self.most)
            wasted += max(0, iterations - self.fresh_iterations)
            if not converged:
                return None, wasted
        return found, wasted

    def _renew(self, matrix: Callable[[], Matrix]) -> None:
        self._is_made = False
        self.make_room()
        self.make(matrix())
        self._is_made = True
        self._wasted = 0
