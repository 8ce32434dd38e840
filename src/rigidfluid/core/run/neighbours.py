"""Two runs beside one run, by its own steps: they go where its linear equations lead."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from rigidfluid.core.contact.pairs.proximity import detect_contacts_and_gaps
from rigidfluid.core.contact.path.body_step import BodyStep, first_step_again, undisturbed
from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.motions import applied_wrench
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.neighbour_step import NeighbourEnd, NeighbourStep
from rigidfluid.core.model.state import MotionState, Past, State
from rigidfluid.core.model.types import Mesh, Step
from rigidfluid.core.run.corners import restarted
from rigidfluid.core.run.prescribed_path import with_prescribed
from rigidfluid.core.run.step import Tools
from rigidfluid.core.run.stepper import Stepper


class Neighbour(NamedTuple):
    """Run beside another one: its ``state``, the ``tools`` by which it steps along with that one, with whose backend,
    and the ``stepper`` by which it takes a step by itself."""

    tools: Tools
    stepper: Stepper
    state: State


Pair = tuple[Neighbour, Neighbour]
"""Neighbours on both sides of a run."""


def followed(tools: Tools, before: State, after: State, pairs: Sequence[Pair]) -> list[Pair]:
    """Neighbours after the step that has led a run from ``before`` to ``after`` on one mesh.

    They take it by themselves without a fluid, and where bodies are near contacts, as path and fluid follow each other
    then. Raises StepRejected where one of them cannot take it.
    """
    before = restarted(tools.system, tools.scheme, tools.clock, before)
    sides = [_restarted(side, before) for pair in pairs for side in pair]
    assert after.level is not None
    step = _OneStep(tools, before, after, after.level)
    if tools.system.has_fluid and before.coupling is None and after.coupling is None:
        states = step.neighbour_states(sides)
    else:
        states = [side.stepper.whole_step(side.state, after.level) for side in sides]
    moved = [side._replace(state=state) for side, state in zip(sides, states, strict=True)]
    return list(zip(moved[::2], moved[1::2], strict=True))


def _restarted(side: Neighbour, before: State) -> Neighbour:
    """The neighbour as the run itself was ``before`` a step: with its applied wrenches, at a corner without a past."""
    tools, state = side.tools, replace(side.state, applied=before.applied)
    return side._replace(state=restarted(tools.system, tools.scheme, tools.clock, state))


class _OneStep:
    """Step of a ``level`` that a run has taken from ``before`` to ``after``."""

    def __init__(self, tools: Tools, before: State, after: State, level: int) -> None:
        self._tools, self._before, self._after, self._level = tools, before, after, level
        self._start, self._size = tools.clock.time(before.tick), tools.clock.size(level)
        self._end = tools.clock.time(after.tick)

    def neighbour_states(self, sides: Sequence[Neighbour]) -> list[State]:
        """States of all after the step in a fluid."""
        paths = [self._predicted(side.tools, side.state) for side in sides]
        if self._tools.scheme.repeats_start(self._before, paths[0]):
            first = self._solved(self._predicted(self._tools, self._before), sides, paths)
            paths = [self._again(side, end) for side, (_, end) in zip(sides, first, strict=True)]
        motions = self._after.motions
        path = undisturbed(self._tools.system, motions.pose, motions.twist, self._end)
        solved = self._solved(with_prescribed(self._tools.system, path, self._end), sides, paths)
        return [self._state(side, *each) for side, each in zip(sides, solved, strict=True)]

    def _predicted(self, tools: Tools, state: State) -> BodyStep:
        path = tools.scheme.follow(state, self._start, self._size, None)
        return with_prescribed(tools.system, path, self._end)

    def _again(self, side: Neighbour, end: NeighbourEnd) -> BodyStep:
        system = side.tools.system
        path = first_step_again(system, side.state, end.twist, self._end, self._size)
        return with_prescribed(system, path, self._end)

    def _solved(
        self, path: BodyStep, sides: Sequence[Neighbour], paths: Sequence[BodyStep]
    ) -> list[tuple[_Moved, NeighbourEnd]]:
        """Steps of the neighbours along their ``paths`` and the ends of these, beside the run's own ``path``."""
        moved = [self._moved(side.tools, side.state, each) for side, each in zip(sides, paths, strict=True)]
        asked = [_asked(side.tools, side.state, each.step) for side, each in zip(sides, moved, strict=True)]
        pairs = list(zip(asked[::2], asked[1::2], strict=True))
        backend = self._tools.system.backend
        own = _asked(self._tools, self._before, self._moved(self._tools, self._before, path).step)
        found = backend.neighbours(own, self._after.fluid, pairs)
        return list(zip(moved, [end for pair in found for end in pair], strict=True))

    def _moved(self, tools: Tools, state: State, path: BodyStep) -> _Moved:
        """Equations of a step along a ``path`` without contacts, and the mesh at its end."""
        motions = path.motions.pose
        mesh = tools.mesh_updater.deform(state, path.pose)
        end = StepEnd(self._end, self._size, motions, nothing(motions))
        return _Moved(path, mesh, step_to(tools.system, state, end, mesh.geometry))

    def _state(self, side: Neighbour, moved: _Moved, end: NeighbourEnd) -> State:
        """The state at the end of a step, with all that the next one needs."""
        (tools, _, state), (path, mesh, step) = side, moved
        applied = None if state.applied is None else applied_wrench(tools.system, state, step.kinematics)
        on_motions = step.kinematics.motion_wrench(end.hydrodynamic_wrench)
        contacts, gaps = detect_contacts_and_gaps(tools.system, path.pose, mesh)
        return replace(
            state,
            tick=self._after.tick,
            count=self._after.count,
            level=self._level,
            pose=path.pose,
            twist=step.kinematics.component_twist(end.twist),
            past=Past(state.motions.pose, state.motions.twist, self._size, applied),
            mesh=mesh,
            fluid=end.fluid,
            coupling=None,
            contacts=contacts,
            gaps=gaps,
            hydrodynamic_wrench=end.hydrodynamic_wrench,
            contact_wrench=nothing(path.pose),
            motions=MotionState(path.motions.pose, end.twist, nothing(path.motions.pose), on_motions),
        )


class _Moved(NamedTuple):
    """A ``path``, the ``mesh`` at its end, and the ``step`` there."""

    path: BodyStep
    mesh: Mesh
    step: Step


def _asked(tools: Tools, state: State, step: Step) -> NeighbourStep:
    problem = tools.system.fluid
    assert problem is not None
    return NeighbourStep(problem, state.fluid, state.mesh, step)
