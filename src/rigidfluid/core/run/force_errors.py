"""Error of the forces on bodies by the mesh, which cells follow with `mesh.goal = "forces"`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.mesh.fluid_domain import fluid_domain_at
from rigidfluid.core.mesh.generation.refined_mesh import refined_mesh
from rigidfluid.core.model.flow_error import RefinedFlow
from rigidfluid.core.model.mesh_error import ErrorEstimate, EstimatedError
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.run.refinement_error import step_in_place
from rigidfluid.errors import MeshError, StepRejected

_FIRST, _EVERY = 4, 20
"""Whole steps on a mesh after which it is judged for the first time, and whole steps from one judgement to the next: a
transferred flow errs more at first, and each takes as long as some ten steps."""


class ErrorOfForces(ErrorEstimate):
    """Error of forces and torques on the bodies, over the root of the sum of their forces' squares; ``time_at`` gives
    the time of a tick [time]."""

    def __init__(self, time_at: Callable[[int], float]) -> None:
        self._time_at = time_at
        self._latest: tuple[State, EstimatedError | None] | None = None

    def is_asked(self, steps: float, age: float) -> bool:
        """Tell so at whole steps alone: once when a mesh has settled, and later now and then."""
        return steps == int(steps) and (_FIRST <= age < _FIRST + 1 or (age > _FIRST and steps % _EVERY == 0))

    def error(self, system: System, state: State) -> EstimatedError | None:
        """Error in the ``state``'s flow; who decides for a mesh and who makes it ask one after the other."""
        if self._latest is None or self._latest[0] is not state:
            self._latest = state, self._estimated(system, state)
        return self._latest[1]

    def _estimated(self, system: System, state: State) -> EstimatedError | None:
        if state.past is None:
            return None
        mesh = state.mesh
        step = step_in_place(system, state, self._time_at(state.tick), 0.0)
        try:
            finer = refined_mesh(mesh, fluid_domain_at(system, state.pose).placed_on(mesh))
            parts = system.backend.force_errors(RefinedFlow(state.fluid, mesh, finer), step)
        except (MeshError, StepRejected):
            return None
        return EstimatedError(parts, float(np.linalg.norm(state.hydrodynamic_wrench.force)), power=1.0)
