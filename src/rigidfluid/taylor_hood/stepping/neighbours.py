"""Steps of runs that differ a little from the one at hand, by the linear equations of its own step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.neighbour_step import NeighbourEnd, NeighbourPair, NeighbourStep
from rigidfluid.core.model.types import FluidState
from rigidfluid.taylor_hood.stepping.advance import (
    Equations,
    coupled_system,
    hydrodynamic_wrench,
    motion_twist,
    state_at_end,
    step_matrix,
    with_momentum_kept,
)
from rigidfluid.taylor_hood.stepping.newton import linearised_about
from rigidfluid.taylor_hood.system.boundary import pressure_load
from rigidfluid.taylor_hood.system.coupled import CoupledSystem, Solution
from rigidfluid.taylor_hood.system.dimensionless import Dimensionless


class _Asked(NamedTuple):
    """Equations of a step, and their linear ``system`` about the solution that is known; with forces ``on_faces``
    (nodes, d)."""

    equations: Equations
    system: CoupledSystem
    on_faces: FloatArray


def neighbours(
    discretisation: Dimensionless,
    solved: NeighbourStep,
    found: FluidState,
    pairs: Sequence[NeighbourPair],
    tolerance: float,
) -> list[tuple[NeighbourEnd, NeighbourEnd]]:
    """Ends y ± δ of ``pairs`` of steps on both sides of a ``solved`` one, whose state at the end y was ``found``."""
    base = _asked(discretisation, solved, found)
    sides = [tuple(_asked(discretisation.twin(each.problem), each, found) for each in pair) for pair in pairs]
    solutions = discretisation.neighbours(base.system, [(a.system, b.system) for a, b in sides], tolerance)
    return [(_end(plus, pair[0]), _end(minus, pair[1])) for (plus, minus), pair in zip(sides, solutions, strict=True)]


def _asked(discretisation: Dimensionless, at: NeighbourStep, found: FluidState) -> _Asked:
    """The equations of a step about the state at its end that was ``found`` for it, or for one beside it."""
    matrix = step_matrix(discretisation, at.fluid, at.mesh, at.step)
    equations = Equations(discretisation, matrix, at.fluid, at.mesh, at.step)
    on_faces = pressure_load(discretisation.surfaces, matrix.node_points, at.step.time)
    system = coupled_system(equations, on_faces)
    if not isinstance(at.problem.material, Newtonian):
        system = linearised_about(discretisation, system, found["velocity"])
    free = ~at.step.prescribed[:, None]
    twist = np.where(free, at.step.kinematics.motion_twist(found["twist"]), system.twist)
    system = replace(system, velocity=found["velocity"], pressure=found["pressure"], twist=twist)
    return _Asked(equations, system, on_faces)


def _end(asked: _Asked, solution: Solution) -> NeighbourEnd:
    equations, on_faces = asked.equations, asked.on_faces
    if solution.jump_load is not None:
        on_faces = on_faces + solution.jump_load
    solution = with_momentum_kept(equations, solution, on_faces)
    state, wrench = state_at_end(equations, solution), hydrodynamic_wrench(equations, solution)
    return NeighbourEnd(state, motion_twist(solution), wrench)
