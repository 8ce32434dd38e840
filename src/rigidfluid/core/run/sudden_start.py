"""Faces of the domain that move, or drive the fluid, from time zero on at once, and what they do to free bodies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoundaryCondition, FloatArray, FluidProblem, Mesh

VANISHING = 1e-3
"""Duration of a sudden start's impulse, over `time.step`: so short that viscosity does nothing."""


def faces_start_at_once(problem: FluidProblem, mesh: Mesh) -> bool:
    """Whether faces give the fluid a velocity at time 0; without inertia pressures do so too."""
    with mesh.ranks.raise_on_all():
        given = _given(problem, mesh)
        found = any(condition.value(0.0, points).any() for condition, points in given if condition.value)
    return bool(mesh.ranks.greatest(found))


def _given(problem: FluidProblem, mesh: Mesh) -> Iterator[tuple[BoundaryCondition, FloatArray]]:
    """The conditions that could, with vertices and centres of their facets."""
    for condition in problem.conditions:
        if condition.type in ("velocity", "wall") or not problem.inertia:
            corners = mesh.points[mesh.facets[mesh.markers == condition.surface]]
            yield condition, np.concatenate([*corners.swapaxes(0, 1), corners.mean(axis=1)])


def struck(system: System, state: State, time_step: float) -> tuple[State, float] | None:
    """A state before the first step after the impulse of faces that start at once, by which free bodies go with the
    fluid; and the fluid's kinetic energy. None where the backend leaves that to the first step."""
    assert state.mesh is not None
    size = VANISHING * time_step
    step = step_to(system, state, StepEnd(size, size, state.motions.pose, nothing(state.motions.pose)), state.mesh)
    after = system.backend.struck(state.mesh, state.pose, state.twist, step)
    if after is None:
        return None
    fluid, kinetic, motions = after
    twist, moving = step.kinematics.component_twist(motions), replace(state.motions, twist=motions)
    return replace(state, fluid=fluid, twist=twist, motions=moving), kinetic
