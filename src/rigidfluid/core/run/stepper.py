"""Takes a run from one accepted state to the next: by the longest step that is allowed, halved until it succeeds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rigidfluid.core.contact.laws.spot_check import is_due, spot_check
from rigidfluid.core.contact.pairs.gap_changes import CLOSEST_APPROACH, WIDEST_OPENING
from rigidfluid.core.contact.path.body_step import BodyStep, first_step_again
from rigidfluid.core.coupling.scheme import Scheme
from rigidfluid.core.coupling.schemes import scheme_of
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.mesh.adaptation.updater import Updater
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.replaceable import Replaceable
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.corners import level_to_corner, restarted
from rigidfluid.core.run.energy_causes import with_cause
from rigidfluid.core.run.error_estimate import estimate_error
from rigidfluid.core.run.impacts import is_unresolved, level_after_impact
from rigidfluid.core.run.prescribed_path import with_prescribed
from rigidfluid.core.run.process import give_back_memory
from rigidfluid.core.run.step import Tools, attempt
from rigidfluid.core.run.step_controller import StepController
from rigidfluid.core.run.stopwatch import Stopwatch
from rigidfluid.core.run.stuck import stuck
from rigidfluid.errors import StepError, StepRejected

MOST_ATTEMPTS = 8
"""Path and fluid of a step with contacts follow each other so many times at most; two are usual."""


@dataclass
class Counts:
    """Counts of a run: steps ``rejected``, steps whose path and fluid did not agree in the end (``unsettled``), meshes
    made after the first (``remeshes``), those that could not be made (``failed_remeshes``), and why the latest of
    them."""

    rejected: int = 0
    unsettled: int = 0
    remeshes: int = 0
    failed_remeshes: int = 0
    latest_failed_remesh: str | None = None


class Stepper:
    """Takes steps, and counts what happens to them.

    The ``system`` may be replaced between steps by one with another motion of its prescribed bodies. ``tolerance``: of
    a step's local error [1]; None for steps as long as the clock allows. ``propose`` gives the level of the next step
    after a state, before gaps and rejections shorten it: the step controller. Another may be put in the place of
    `longest`, or of `StepController.propose` with a tolerance.
    """

    propose = Replaceable()

    def __init__(
        self,
        system: System,
        clock: Clock,
        mesh_updater: Updater,
        watch: Stopwatch,
        tolerance: float | None = None,
    ) -> None:
        self._clock, self._mesh_updater, self._watch = clock, mesh_updater, watch
        self.system = system
        self.counts = Counts()
        self._controller = None if tolerance is None else StepController(clock, tolerance)
        self.propose = self._controller.propose if self._controller else self.longest

    @property
    def system(self) -> System:
        """The present system."""
        return self._system

    @system.setter
    def system(self, system: System) -> None:
        self._system, self._scheme = system, scheme_of(system)

    @property
    def scheme(self) -> Scheme:
        """Scheme of the present system's steps."""
        return self._scheme

    def longest(self, state: State) -> int:
        """The level of the longest step on the clock's grid, at most twice the last, and after a start at once at most
        half of the time since."""
        level = self._clock.longest_level(state.tick, state.level)
        if state.past is not None and self._clock.size(level) > 0.5 * state.ledger.since_start:
            return max(level, state.level or 0)
        return level

    def after(self, state: State) -> State:
        """The next accepted state; raises StepError where even the shortest step is rejected."""
        state = restarted(self.system, self.scheme, self._clock, state)
        level, path = self._first_level(state)
        while True:
            try:
                path = path or self._path(state, level)
                state = self._on_its_mesh(state, path.pose)
                new, agreed = self._tried(state, level, path)
                new = self._judged(state, new)
            except StepRejected as rejection:
                self.counts.rejected += 1
                level, path = level + 1, None
                if level > self._clock.levels:
                    time, shortest = self._clock.time(state.tick), self._clock.size(self._clock.levels)
                    raise stuck(self.system, state, rejection, time, shortest) from rejection
            else:
                self.counts.unsettled += not agreed
                if is_due(new.count):
                    spot_check(self.system, new.pose, new.mesh, new.count)
                return with_cause(self.system, self._clock, state, new)

    def whole_step(self, state: State, level: int) -> State:
        """State one step of this level later on the same mesh, if that can be; raises StepRejected if not."""
        return self._tried(state, level, self._path(state, level))[0]

    def _judged(self, state: State, candidate: State) -> State:
        """The candidate with an estimate of its error, where that is tolerated."""
        if self._controller is None:
            return candidate
        with self._watch("estimate"):
            estimate = estimate_error(self.system, self._clock.time(candidate.tick), state, candidate)
        candidate = replace(candidate, estimate=estimate)
        self._controller.judge(candidate)
        return candidate

    def _on_its_mesh(self, state: State, pose: Pose) -> State:
        """The state on a new mesh, if a step to ``pose`` asks for one; it is as good where that is rejected."""
        with self._watch("mesh"):
            adapted = self._mesh_updater.remesh_if_needed(state, pose)
            if adapted.mesh is not state.mesh:
                give_back_memory()
        self.counts.remeshes += adapted.mesh is not state.mesh
        failed = adapted.remesh_failed
        if failed is not None and failed is not state.remesh_failed:
            self.counts.failed_remeshes += 1
            self.counts.latest_failed_remesh = f"at time {self._clock.time(failed.tick):g}: {failed.reason}"
        return adapted

    def _tried(self, state: State, level: int, path: BodyStep) -> tuple[State, bool]:
        """The state one step of this level later, and whether path and fluid agree there; nothing is changed."""
        scheme, size = self.scheme, self._clock.size(level)
        tools = Tools(self.system, scheme, self._clock, self._mesh_updater, self._watch)
        for number in range(MOST_ATTEMPTS):
            provisional = number == 0 and scheme.is_unsteady(state, path, size)
            candidate, step = attempt(tools, state, level, path, provisional)
            if level < self._clock.levels and self.system.detection.has_missed(state.contacts, candidate.contacts):
                raise _too_fast()
            if number == 0 and scheme.repeats_start(state, path):
                again = first_step_again(self.system, state, candidate.motions.twist, self._end(state, level), size)
                path = with_prescribed(self.system, again, self._end(state, level))
                continue
            with self._watch("response"):
                candidate, agree = scheme.converge(state, candidate, path, step)
            agreed = agree and not provisional
            if agreed or number == MOST_ATTEMPTS - 1:
                break
            path = self._path(state, level, candidate.coupling)
            if level < self._clock.levels and self._changes_gaps_too_fast(state, path.pose):
                raise _too_fast()
        return candidate, agreed

    def _path(self, state: State, level: int, coupling: Coupling | None = None) -> BodyStep:
        """The bodies' way through a step, with a ``coupling`` that an attempt has shown or else the expected one."""
        time, size = self._clock.time(state.tick), self._clock.size(level)
        if coupling is None:
            with self._watch("response"):
                coupling = self.scheme.expect(state, time, size)
        with self._watch("contact"):
            path = self.scheme.follow(state, time, size, coupling)
        return with_prescribed(self.system, path, self._end(state, level))

    def _end(self, state: State, level: int) -> float:
        """Time when a step of this level ends [time]."""
        return self._clock.time(state.tick + self._clock.ticks(level))

    def _first_level(self, state: State) -> tuple[int, BodyStep | None]:
        """The longest step, of those proposed and shorter ones, that changes no gap too fast and resolves its impacts,
        and the way it takes."""
        level = level_to_corner(self.system, self._clock, state.tick, self.proposed(state))
        level = level_after_impact(state, self._clock, level)
        while level < self._clock.levels:
            try:
                path = self._path(state, level)
            except StepRejected:
                break
            if not (is_unresolved(state, path, level) or self._changes_gaps_too_fast(state, path.pose)):
                return level, path
            level += 1
        return level, None

    def proposed(self, state: State) -> int:
        """Level that the step controller gives, which may be the caller's; one beyond the last where no step will do.

        Raises StepError where it is no level.
        """
        level = self.propose(state)
        is_number = isinstance(level, int | np.integer) and not isinstance(level, bool)
        if not (is_number and 0 <= level <= self._clock.levels):
            allowed = f"a whole number from 0, time.step, to {self._clock.levels - 1}, time.shortest"
            raise StepError("stepper.propose", describe(level), allowed, "Let it return the number of halvings.")
        return int(level)

    def _changes_gaps_too_fast(self, state: State, pose: Pose) -> bool:
        """Tell whether the mesh in a gap would be squeezed, or a film opened, by more than a step can follow."""
        with self._watch("detect"):
            return self.scheme.changes_gaps_too_fast(state, pose, partial(self._mesh_updater.deform, state))


def _too_fast() -> StepRejected:
    found = (
        f"a gap that closes to less than {CLOSEST_APPROACH} of it, a film that opens more than {WIDEST_OPENING}-fold"
    )
    found += " or a contact that was out of sight"
    return StepRejected("the step", found, "slower changes", "Shorten time.step.")
