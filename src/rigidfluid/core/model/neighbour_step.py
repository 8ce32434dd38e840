"""A step of a run whose values differ a little from those of the run at hand."""

from __future__ import annotations

from dataclasses import dataclass

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.model.types import FluidState, Mesh, Step, Twist, Wrench


@dataclass(frozen=True, slots=True)
class NeighbourStep:
    """Arguments of a backend's ``advance`` in a run with another ``problem``, whose mesh has the same cells."""

    problem: FluidProblem
    fluid: FluidState
    mesh: Mesh
    step: Step


NeighbourPair = tuple[NeighbourStep, NeighbourStep]
"""Steps of two runs at a value p + h and p - h, on both sides of the run at p."""


@dataclass(frozen=True, slots=True)
class NeighbourEnd:
    """The fluid's state at the end of a step, the motions' ``twist``, and the fluid's wrench on each body."""

    fluid: FluidState
    twist: Twist
    hydrodynamic_wrench: Wrench
