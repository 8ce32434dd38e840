"""A run that goes on step by step: its state, who watches it, and what is written when."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.case.population import (
    Population,
    named_table,
    refuse_known_name,
    refuse_staying,
    require_one_process,
    subjects_by_name,
)
from rigidfluid.core.case.scene_model import Case, model_of
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.memory import told_memory
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.output.checkpoint import Checkpoint
from rigidfluid.core.output.extremes import Extremes
from rigidfluid.core.output.fluid_fields import FluidFields
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns_of, count_cells
from rigidfluid.core.output.writer import has_checkpoint
from rigidfluid.core.run.body_now import BodyNow, bodies_now
from rigidfluid.core.run.caller_input import (
    folder_of,
    interval_of,
    over_time,
    require_function,
    require_processes,
    require_truth,
    time_of,
    twist_row,
    wrench_row,
)
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.control import body_row, following, present_motion, with_applied
from rigidfluid.core.run.exchange import exchanged, successor
from rigidfluid.core.run.exchange_rows import exchange_rows
from rigidfluid.core.run.fluid_now import fluid_now
from rigidfluid.core.run.initial_state import initial_state
from rigidfluid.core.run.mesh_keys import updater_of
from rigidfluid.core.run.observers import Observer, Observers
from rigidfluid.core.run.process import one_openblas_thread
from rigidfluid.core.run.recorder import Recorder
from rigidfluid.core.run.resumption import earlier_of, recall_memory
from rigidfluid.core.run.run_timer import RunTimer
from rigidfluid.core.run.saved_run import SavedRun, require_saved
from rigidfluid.core.run.schedule import Schedule
from rigidfluid.core.run.stepper import Counts, Stepper
from rigidfluid.core.run.stopwatch import Stopwatch
from rigidfluid.core.run.summary import summarise
from rigidfluid.core.run.velocity_jump import halvings_after, halvings_within, shortened
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.named_files import file_digests
from rigidfluid.core.setup.prescribed import PrescribedMotion
from rigidfluid.described import Described, first_names
from rigidfluid.errors import ArgumentError, MeshError, OutputError, SceneError, StepError

if TYPE_CHECKING:
    from rigidfluid.core.case.moment import SinkRegions


class Simulation(Described):
    """A run in progress: the latest accepted state, and all that it takes to reach the next one.

    Parameters
    ----------
    case : Scene or Model
        What to run.
    out : Path or None
        Folder for the results, or None.
    resume : bool
        Whether to go on from the checkpoint there.
    processes : int or None
        How many processes were started to share the run; None if the backend's own ranks are those.

    Between steps ``state`` may be looked at, ``stepper.propose`` be another step controller, and
    ``mesh_updater.needs_remesh`` another rule of re-meshing. ``origin`` is the model that the run began with, ``model``
    that of the bodies which are there now.
    """

    def __init__(
        self,
        case: Case,
        out: Path | None = None,
        resume: bool = False,
        processes: int | None = None,
    ) -> None:
        self.model = model = model_of(case)
        out = folder_of(out)
        require_truth("resume", resume)
        with told_memory():
            system = assemble(model)
        self._ranks = system.backend.ranks
        require_processes(processes, system.backend)
        self.clock = Clock.for_steps(model.time.step, model.time.shortest, model.time.end)
        files = {} if out is None else file_digests(model.document)
        self.origin, self.population = model, Population()
        earlier = None
        if resume:
            earlier, self.model, system = earlier_of(model, out, system, self.clock, files)
            self.population = Population.from_dict(json.loads(earlier.population))
        self.watch = Stopwatch()
        self.mesh_updater = updater_of(model.fluid, system, self.clock, self.watch)
        self.stepper = Stepper(system, self.clock, self.mesh_updater, self.watch, model.time.tolerance)
        history = History(model.dimension, folder=out, columns_by_table=columns_of(system))
        probes = np.array(model.output.probes, dtype=float).reshape(-1, model.dimension)
        self.recorder = Recorder(history, Extremes.none(len(system.bodies)), files, probes)
        self._timer = RunTimer()
        self._observers = Observers()
        try:
            with told_memory(), self._threads():
                if earlier is None:
                    self._begin(out)
                else:
                    assert out is not None
                    self._take_up(out, earlier)
        except BaseException:
            self.close()
            raise

    @property
    def system(self) -> System:
        """System that the run moves; `prescribe`, `add`, `remove` and `restore` replace it, and sources and sinks."""
        return self.stepper.system

    @property
    def state(self) -> State:
        """The latest accepted state."""
        return self._state

    @state.setter
    def state(self, state: State) -> None:
        if not isinstance(state, State):
            raise ArgumentError("state", describe(state), "a State", "Leave it to the run; `restore` goes back.")
        self._state = state

    @property
    def history(self) -> History:
        """Rows of all states until now."""
        return self.recorder.history

    @property
    def alone(self) -> bool:
        """Tell whether no other process shares the run."""
        return self._ranks.size == 1

    @property
    def elapsed(self) -> float:
        """Wall seconds of this run, those before a resumption included."""
        return self._timer.elapsed

    @property
    def cpu_time(self) -> float:
        """CPU seconds of this process, of all its threads, those before a resumption included."""
        return self._timer.cpu_time

    @property
    def time(self) -> float:
        """Time of the present state [time]."""
        return self.clock.time(self.state.tick)

    @property
    def ended(self) -> bool:
        """Tell whether the scene's end is reached."""
        return self.state.tick >= self.clock.last_tick

    @property
    def counts(self) -> Counts:
        """Steps rejected and meshes made."""
        return self.stepper.counts

    @property
    def sensitivities_ended(self) -> str | None:
        """Why there are no derivatives from some time on, None where there are, or none are wanted."""
        companions = self.recorder.companions
        if companions.has_sensitivities:
            return companions.sensitivities_ended
        return "the run was resumed" if self.model.output.sensitivities else None

    @property
    def bodies(self) -> dict[str, BodyNow]:
        """All bodies by name, as they are now, and after them the mechanisms as wholes."""
        return bodies_now(self.system, self.state)

    def fields(self) -> FluidFields:
        """Fields of the fluid at present, as `RunResults.fields` reads those of an output.

        Returns
        -------
        FluidFields
            Arrays and the time; where several processes share the run, those of this one's cells.

        Raises
        ------
        OutputError
            If the bodies move without a fluid.
        """
        if not count_cells(self.state.mesh):
            found, allowed = f"none, as {self.model.name!r} has no fluid", "those of a scene with a fluid"
            raise OutputError("fields", found, allowed, "Give [fluid] a backend with a mesh, as scikit-fem.")
        return fluid_now(self.system, self.state, self.time)

    def step(self) -> State:
        """Take one accepted step, record it, call who is due, and return the new state.

        Raises
        ------
        StepError
            Where even the shortest step fails, a body that is due to enter or leave cannot, memory does not suffice,
            or the scene's end was reached before.
        OutputError
            Where the disk refuses, or the simulation, which writes to a folder, was closed.
        """
        self.recorder.refuse_closed("a step")
        if self.ended:
            remedy = "Move time.end in the scene."
            raise StepError("a step", f"one after the end, {self.time:g}", f"steps until {self.clock.end:g}", remedy)
        self._exchange_due()
        with told_memory(), self._threads():
            before, self.state = self.state, self.stepper.after(self.state)
            self.recorder.companions.follow(self, before)
        self.recorder.record(self)
        self._observers.call(self)
        return self.state

    def go(self, until: float = np.inf) -> None:
        """Step until this time [time], or the scene's end; raises SceneError where it is no number."""
        until = max(time_of("until", until), 0.0)
        last = self.clock.last_tick if until >= self.clock.end else self.clock.tick_from(until)
        while self.state.tick < last:
            self.step()

    def observe(self, observer: Observer, every: float | None = None) -> None:
        """Call ``observer`` with this simulation after each accepted step, or after those that reach a multiple of
        ``every`` [time]; raises SceneError where that is no time above 0, or the observer no function."""
        require_function("observer", observer, "a function of the simulation")
        if every is not None:
            every = interval_of("every", every)
        self._observers.add(Schedule(self.clock, every, self.time), observer)

    def prescribe(
        self,
        name: str,
        velocity: Sequence[float] | None = None,
        angular_velocity: Sequence[float] | None = None,
        over: float | None = None,
    ) -> None:
        """Move a body that is fixed or prescribed so from now on, after a linear change ``over`` a time.

        Without such a time velocities jump; in a fluid they change within the next step, which is halved the more, the
        more they jump, see `halvings_after`.

        Parameters
        ----------
        name : str
            Of the body.
        velocity, angular_velocity : sequence of float, optional
            (d,) and (k,); zero if not given [length/time, rad/time].
        over : float, optional
            Time in which the body goes from the velocities it has to these [time].

        Raises
        ------
        SceneError
            If there is no such body, it is free, or a value is not allowed.
        """
        row, now = body_row(self.system, name, True), self.system.prescribed_twist(self.time)
        twist = twist_row(self.model.dimension, velocity, angular_velocity)
        within = over_time(over, now[row], twist)
        if self.system.has_fluid:
            step = self.clock.size(0)
            halvings = halvings_within(halvings_after(self.system, self.state, row, twist, step), step, over)
            self.state = shortened(self.state, self.clock, halvings)
            within = within or self.clock.size(self.stepper.proposed(self.state))
        motion = present_motion(self.model, self.system, self.state).changed(row, twist, self.time, within)
        self.state = replace(self.state, prescription=motion.rows)
        self.stepper.system = following(self.system, motion)

    def apply(self, name: str, force: Sequence[float] | None = None, torque: Sequence[float] | None = None) -> None:
        """Apply a force at the centre of mass of a free body, and a torque, from now on until they are changed.

        They are constant in the lab frame; their work is in the column ``control`` of the energies.

        Parameters
        ----------
        name : str
            Of the body, or of a component of a mechanism.
        force, torque : sequence of float, optional
            (d,) and (k,); zero if not given [force, force·length].

        Raises
        ------
        SceneError
            If there is no such body, it is fixed or prescribed, or a value is not allowed.
        """
        row, wrench = body_row(self.system, name, False), wrench_row(self.model.dimension, force, torque)
        self.state = with_applied(self.state, row, wrench)

    def add(self, body: Mapping[str, object]) -> None:
        """Let a body enter, from now on: in a fluid, in the place of what was there.

        The domain is re-meshed around all bodies, the flow is the nearest to the one before that goes with the body,
        and steps are as short as after a start. Energy that comes with the body is in the column ``exchange`` of the
        energies.

        Parameters
        ----------
        body : mapping
            Keys of a ``[[body]]`` table, with a name that none of the run has had.

        Raises
        ------
        SceneError
            If the table is wrong or has a spring or held directions, the body overlaps another one or a wall, or there
            are a window, a scalar, several processes, or a backend whose bodies cannot change.
        MeshError
            If no mesh can be made around it.
        """
        table = named_table(body)
        refuse_known_name(self.population, self.model, table["name"])
        self._exchange(self.population.with_body(table, self.time))

    def remove(self, name: str) -> None:
        """Let a body leave, from now on: in a fluid, which takes its place with its velocity.

        Parameters
        ----------
        name : str
            Of the body.

        Raises
        ------
        SceneError
            If there is no such body, a joint, a spring to the ground or a mechanism holds it, it is the last one, or
            bodies cannot change, as for `add`.
        MeshError
            If no mesh can be made without it.
        """
        refuse_staying(self.model, name)
        self._exchange(self.population.without(name))

    def save(self) -> SavedRun:
        """Keep the run as it is now, in memory; what follows equals what follows `restore` to the last bit."""
        return SavedRun(
            model=self.model,
            population=self.population,
            state=self.state,
            memory=self.system.backend.memory(),
            system=self.system,
            counts=replace(self.counts),
            extremes=self.recorder.extremes,
            rows=self.history.lengths,
            reached=self._observers.latest,
            neighbours=self.recorder.companions.save(),
        )

    def restore(self, saved: SavedRun) -> None:
        """Go back to where the run was saved; raises OutputError where its results go to a folder, SceneError where
        another model's run was saved, or this is no saved run."""
        require_saved(saved, self.model)
        if self.recorder.folder is not None:
            raise OutputError(
                str(self.recorder.folder),
                "a run that writes there and is to go back",
                "a run in memory",
                "Make the Simulation without a folder, or resume the run from its checkpoint.",
            )
        self._follow(saved.model, saved.system, saved.population)
        self.system.backend.recall(saved.memory, saved.state.mesh)
        self.state, self.recorder.extremes = saved.state, saved.extremes
        self.stepper.counts = replace(saved.counts)
        self.history.cut(saved.rows)
        self._observers.go_back(saved.reached)
        self.recorder.companions.go_back(self, saved.neighbours)

    def finish(self, status: str) -> None:
        """Sum up, in memory and on disk; raises SceneError where the status is no text, OutputError where the disk
        refuses, or the simulation, which writes to a folder, was closed."""
        self.recorder.refuse_closed("a summary")
        if not isinstance(status, str):
            raise ArgumentError("status", describe(status), "a text", "Say in a word how the run ended.")
        self.recorder.finish(summarise(self, status))

    def close(self) -> None:
        """Let other runs write to the folder; a simulation that writes takes no step after that."""
        self.recorder.close()

    @cached_property
    def _sink_regions(self) -> SinkRegions:
        """Regions of the scene's sinks, read once."""
        from rigidfluid.core.case.sinks import sink_regions

        return sink_regions(self.origin)

    def _exchange_due(self) -> None:
        """Let bodies enter and leave by the sources and sinks of the scene."""
        if not (self.model.source_tables or self.model.sink_tables):
            return
        require_one_process(self.system.backend)
        from rigidfluid.core.case.moment import Moment  # few scenes have any
        from rigidfluid.core.case.population_due import population_due

        try:
            now = Moment(self.model, self.system, self.state, self.population, self.time, self._sink_regions)
            population = population_due(now)
            if population != self.population:
                self._exchange(population)
        except (SceneError, MeshError) as error:
            at = f"bodies that enter or leave at time {self.time:.6g}"
            raise StepError(at, str(error).rstrip("."), None, "What was computed until then is kept.") from error

    def _exchange(self, population: Population) -> None:
        """Go on with other bodies; nothing is changed where they do not fit."""
        require_one_process(self.system.backend)
        self.recorder.refuse_closed("an exchange of bodies")
        before, state = (self.model, self.system, self.population), self.state
        with told_memory(), self._threads(), self.watch("mesh"), subjects_by_name(population.names(self.origin)):
            next_one = successor(self.origin, self.model, self.system, state, population, self.time)
            self._follow(next_one.model, next_one.exchange.after, next_one.population)
            try:
                self.state = exchanged(next_one, state, self.mesh_updater, self.clock)
            except BaseException:
                self._follow(*before)
                raise
        stay = next_one.exchange.bodies
        self.recorder.extremes = self.recorder.extremes.among(stay.kept, stay.places, len(self.system.bodies))
        self.recorder.record_exchange(exchange_rows(next_one.exchange, state, self.state, self.time), self)

    def _follow(self, model: Model, system: System, population: Population) -> None:
        """Go on with a system, of the model's bodies."""
        self.model, self.population = model, population
        self.stepper.system = self.mesh_updater.system = system

    def _facts(self) -> Mapping[str, object]:
        gap = float(self.state.gaps.min(initial=np.inf))
        return {
            "scene": self.model.name,
            "time": f"{self.time:.6g} of {self.clock.end:.6g}",
            "steps": self.state.count,
            "bodies": first_names(tuple(self.bodies)),
            "cells": count_cells(self.state.mesh) or None,
            "smallest gap": gap if np.isfinite(gap) else None,
            "folder": self.recorder.folder,
        }

    def _threads(self) -> AbstractContextManager[object]:
        """One thread of OpenBLAS in a fluid: without one there are no vectors that it would share out."""
        return one_openblas_thread() if self.system.has_fluid else nullcontext()

    def _begin(self, out: Path | None) -> None:
        with self.watch("mesh"):
            self.state = initial_state(
                self.system, self.mesh_updater, self.clock, self.model.time.tolerance is not None
            )
        self.recorder.companions.begin_sensitivities(self)
        self.recorder.companions.begin_error_bars(self)
        if self._ranks.bcast(out is not None and has_checkpoint(out)):
            self._rehearse()
        if out is not None:
            self.recorder.write_to(out, self)
        self.recorder.record(self)
        self.recorder.output(self)
        self.observe(self.recorder.output, self.model.output.every)

    def _rehearse(self) -> None:
        """Try the first step before an earlier run's results are replaced; a scene that cannot start leaves them."""
        self.stepper.after(self.state)
        self.system.backend.forget()
        self.stepper.counts = Counts()

    def _take_up(self, out: Path, earlier: Checkpoint) -> None:
        self.state = earlier.state
        recall_memory(out, earlier, self.system.backend)
        self.stepper.counts = Counts(**{field.name: getattr(earlier, field.name) for field in fields(Counts)})
        self._timer.add(earlier.elapsed, earlier.cpu_time)
        self.watch.seconds = dict(earlier.seconds)
        if self.state.prescription is not None:
            self.stepper.system = following(self.system, PrescribedMotion(self.state.prescription))
        self.recorder.companions.begin_error_bars(self)
        self.recorder.write_to(out, self, earlier)
        self.observe(self.recorder.output, self.model.output.every)
