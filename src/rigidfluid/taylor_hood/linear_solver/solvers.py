"""Two solvers that are kept from topology to topology: for matrices of steps, and for those of masses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

Solver = TypeVar("Solver")


@dataclass(frozen=True)
class Solvers(Generic[Solver]):
    """Solver for matrices with viscosity, which steps have, and one for ``inviscid`` ones, as projections and impulsive
    answers have: the preconditioner of one serves the other badly."""

    viscous: Solver
    inviscid: Solver

    def select(self, viscosity: float) -> Solver:
        """The solver for a matrix with this viscosity."""
        return self.inviscid if viscosity == 0.0 else self.viscous
