"""A Krylov iteration preconditioned by what an earlier step's matrix gave, which is renewed when that pays."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar, Generic, TypeVar, final

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.ranks import Ranks
from rigidfluid.errors import StepRejected
from rigidfluid.taylor_hood.linear_solver.known_answers import KnownAnswers

Matrix = TypeVar("Matrix")

_RECYCLED = 2
"""Number of steps whose corrections are kept. The error of a linear extrapolation in time changes little from step to
step: a combination of them leaves a hundredth of it, as an extrapolation of two orders more would, whatever the steps
are."""

_PARALLEL = 1e-10
"""Relative size of what is new in a vector, below which it is rounding."""


@dataclass(frozen=True)
class Operator(Generic[Matrix]):
    """Matrix A of a linear system: ``apply(x)`` is A x, ``build()`` gives A where preconditioners are made of it."""

    apply: Callable[[FloatArray], FloatArray]
    build: Callable[[], Matrix]


class LaggedSolver(ABC, Generic[Matrix]):
    """Solves A x = b for a matrix that changes little from step to step.

    The preconditioner is renewed when the iterations beyond those that a fresh one would have taken add up to the cost
    of a new one: a rule of counts, not of clock time, so that a run can be repeated to the last bit.

    ``rebuild_cost`` of a preconditioner in iterations by dimension; ``fresh_iterations``, that a solve then takes; and
    the ``most`` that may be spent on one. An old one is given up when it has wasted that cost twice.
    """

    rebuild_cost: ClassVar[Mapping[int, int]]
    sharper: ClassVar[float] = 1.0
    """Factor on the tolerance of impulse responses [1]: the ratio of their residual to the one asked of LU factors."""
    fresh_iterations: ClassVar[int]
    most: ClassVar[int]

    def __init__(self, ranks: Ranks, dimension: int) -> None:
        self._ranks = ranks
        self._rebuild_cost = self.rebuild_cost[dimension]
        self._wasted = 0
        self._is_made = False
        self._corrections: tuple[FloatArray, ...] = ()
        self._answers = KnownAnswers()

    @property
    def is_made(self) -> bool:
        """Tell whether there is a preconditioner."""
        return self._is_made

    @final
    def forget(self) -> None:
        """Drop the preconditioner, the corrections of earlier solutions, and all answers."""
        self._is_made = False
        self._corrections = ()
        self._answers = KnownAnswers()
        self.drop()

    @final
    def memory(self) -> dict[str, FloatArray]:
        """State of the solver that the next solution depends on, besides the matrix of the preconditioner."""
        own = {"wasted": np.array(float(self._wasted)), "corrections": np.array(self._corrections)}
        return own | self._answers.memory()

    @final
    def recall(self, memory: Mapping[str, FloatArray], matrix: Callable[[], Matrix]) -> None:
        """Go on from what `memory` gave, with a preconditioner made from that matrix."""
        self._renew(matrix)
        self._wasted, self._corrections = int(memory["wasted"]), tuple(memory["corrections"])
        self._answers = KnownAnswers.recalled(memory)

    @final
    def solve(
        self,
        operator: Operator[Matrix],
        residual: FloatArray,
        tolerance: float,
        outdated: bool = False,
        again: bool = False,
    ) -> tuple[FloatArray, int]:
        """The correction x with ‖residual - A x‖ ≤ tolerance, and the iterations spent; raises StepRejected.

        A new preconditioner is made at once where the old one is ``outdated``. ``again``: the guess is a solution of
        nearly the same system, and what corrects it has nothing to do with the corrections of steps. Vectors are this
        process' part.
        """
        start = self.norm(residual)
        if not np.isfinite(start):
            raise StepRejected("fluid", f"a residual of {start}", "finite numbers", "Shorten time.step.")
        if start <= tolerance:
            return np.zeros_like(residual), 0
        recycled, left = (np.zeros_like(residual), residual) if again else self._recycle(operator.apply, residual)
        correction, iterations = self._iterate(operator, left, tolerance, outdated)
        correction = recycled + correction
        if not again:
            self._corrections = (correction, *self._corrections)[:_RECYCLED]
        self._wasted += max(0, iterations - self.fresh_iterations)
        return correction, iterations

    def _iterate(
        self,
        operator: Operator[Matrix],
        residual: FloatArray,
        tolerance: float,
        outdated: bool,
    ) -> tuple[FloatArray, int]:
        if self.norm(residual) <= tolerance:
            return np.zeros_like(residual), 0
        fresh = not self._is_made or outdated or self._wasted > self._rebuild_cost
        if fresh:
            self._renew(operator.build)
        most = self.most if fresh else min(self.most, self.fresh_iterations + 2 * self._rebuild_cost)
        correction, iterations, converged = self.iterate(operator.apply, residual, tolerance, most)
        if not converged and not fresh:
            self._renew(operator.build)
            correction, iterations, converged = self.iterate(operator.apply, residual, tolerance, self.most)
        if not converged:
            self.forget()  # the next step tried is another one
            raise StepRejected(
                "fluid.tolerance",
                f"a linear system that does not converge to {tolerance:.1e} in {self.most} iterations",
                "a converging one",
                "Shorten time.step or loosen fluid.tolerance.",
            )
        return correction, iterations

    def _recycle(
        self, apply: Callable[[FloatArray], FloatArray], residual: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """The combination x of earlier corrections with the least ‖residual - A x‖, and that residual."""
        found, left = np.zeros_like(residual), residual
        basis: list[tuple[FloatArray, FloatArray]] = []
        for vector in self._corrections:
            image = apply(vector)
            whole = self.norm(image)
            for other, image_of_other in basis:
                share = self._ranks.sum(image_of_other @ image)
                vector, image = vector - share * other, image - share * image_of_other
            size = self.norm(image)
            if not size > _PARALLEL * whole:
                continue
            basis.append((vector / size, image / size))
            share = self._ranks.sum(basis[-1][1] @ left)
            found, left = found + share * basis[-1][0], left - share * basis[-1][1]
        return found, left

    @final
    def solve_loads(
        self, operator: Operator[Matrix], right_sides: FloatArray, tolerance: float, loads: FloatArray
    ) -> FloatArray:
        """The same as `solve_columns` for the right sides of ``loads`` (t, c), from the latest answers to these on."""
        known = self._answers if self._is_made else KnownAnswers()
        guess = known.guess(loads, len(right_sides))
        found = self.solve_columns(operator, right_sides, tolerance, guess)
        self._answers = known.with_latest(loads, found)
        return found

    @final
    def solve_columns(
        self,
        operator: Operator[Matrix],
        right_sides: FloatArray,
        tolerance: float,
        guess: FloatArray | None = None,
    ) -> FloatArray:
        """x with A x = each column of ``right_sides`` (N, c), to ``tolerance`` times its norm, from a ``guess`` (N, c)
        on; raises StepRejected.

        Iterations wasted by an old preconditioner count like those of a step.
        """
        enough = np.array([self.sharper * tolerance * self.norm(right_side) for right_side in right_sides.T])
        left = right_sides if guess is None or not guess.any() else right_sides - operator.apply(guess)
        fresh = not self._is_made
        if fresh:
            self._renew(operator.build)
        found, wasted = self.iterate_columns(operator.apply, left, enough)
        if found is None and not fresh:
            self._renew(operator.build)
            found, wasted = self.iterate_columns(operator.apply, left, enough)
        self._wasted += wasted
        if found is None:
            self.forget()
            raise StepRejected(
                "fluid.backend",
                f"impulse responses that do not converge to {tolerance:.1e}",
                "converging ones",
                "Shorten time.step, or look at the mesh near the bodies.",
            )
        return found if guess is None else guess + found

    @final
    def solve_aside(self, operator: Operator[Matrix], right_sides: FloatArray, tolerance: float) -> FloatArray:
        """The same with the preconditioner at hand, where it serves: the steps go on as if it had not been asked."""
        if not self._is_made:
            self._renew(operator.build)
        found = np.zeros_like(right_sides)
        for column in range(right_sides.shape[1]):
            right_side = right_sides[:, column]
            enough = tolerance * self.norm(right_side)
            if enough > 0.0:
                found[:, column] = self._solved_aside(operator, right_side, enough)
        return found

    def _solved_aside(self, operator: Operator[Matrix], right_side: FloatArray, enough: float) -> FloatArray:
        found, _, converged = self.iterate(operator.apply, right_side, enough, self.most)
        if not converged:
            self._renew(operator.build)
            found, _, converged = self.iterate(operator.apply, right_side, enough, self.most)
        if not converged:
            shown = f"sensitivities that do not converge to {enough:.1e} in {self.most} iterations"
            raise StepRejected("fluid.tolerance", shown, "converging ones", "Loosen fluid.tolerance.")
        return found

    @final
    def norm(self, vector: FloatArray) -> float:
        """Euclidean norm of a distributed vector, over all processes."""
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
        self, apply: Callable[[FloatArray], FloatArray], right_sides: FloatArray, enough: FloatArray
    ) -> tuple[FloatArray | None, int]:
        """The solutions (N, c) to residuals of ``enough`` (c,), or None where one was not reached, and the iterations
        that fresh factors would save."""
        found, wasted = np.zeros_like(right_sides), 0
        for column, residual in enumerate(enough):
            right_side = right_sides[:, column]
            if self.norm(right_side) <= residual:
                continue
            found[:, column], iterations, converged = self.iterate(apply, right_side, residual, self.most)
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
