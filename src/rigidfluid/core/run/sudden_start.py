"""Faces of the domain that move, or drive the fluid, from time zero on at once, and what they do to free bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Mesh

VANISHING = 1e-3
"""Duration of a sudden start's impulse, over `time.step`: so short that viscosity does nothing."""


def faces_start_at_once(problem: FluidProblem, mesh: Mesh) -> bool:
    """Tell whether faces give the fluid a velocity at time 0; without inertia pressures do so too."""
    with mesh.ranks.raise_on_all():
        found = any(_drives_at_once(condition, problem.inertia, mesh) for condition in problem.conditions)
    return bool(mesh.ranks.greatest(found))


def _drives_at_once(condition: BoundaryCondition, inertia: bool, mesh: Mesh) -> bool:
    """Tell whether a condition is not zero at time 0, at vertices and centres of its facets."""
    if condition.held_flux is not None:
        return condition.held_flux(0.0) != 0.0
    corners = mesh.points[mesh.facets[mesh.markers == condition.surface]]
    points = np.concatenate([*corners.swapaxes(0, 1), corners.mean(axis=1)])
    driven = condition.velocity(0.0, points).any()
    return bool(driven or (not inertia and condition.pressure(0.0, points).any()))


def struck(system: System, state: State, time_step: float) -> tuple[State, float] | None:
    """A state before the first step after the impulse of faces that start at once, by which free bodies go with the
    fluid; and the fluid's kinetic energy. None where the backend leaves that to the first step."""
    size = VANISHING * time_step
    end = StepEnd(size, size, state.motions.pose, nothing(state.motions.pose))
    step = step_to(system, state, end, state.mesh.geometry)
    after = system.backend.struck(state.mesh, state.pose, state.twist, step)
    if after is None:
        return None
    fluid, kinetic, motions = after
    twist, moving = step.kinematics.component_twist(motions), replace(state.motions, twist=motions)
    return replace(state, fluid=fluid, twist=twist, motions=moving), kinetic
