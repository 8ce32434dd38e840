"""The loop: choose a step, try it, accept it or try a shorter one, write what is due."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rigidfluid.core.contact.contact_path import BodiesPath, first_step_again, follow
from rigidfluid.core.contact.coupling import expected_coupling, settled, shown_coupling, unforeseen
from rigidfluid.core.contact.proximity import least_gaps, surroundings, travel
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.mesh.mesh_adaptation import Mover, reference_of
from rigidfluid.core.mesh.size_field import Sizes
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.interfaces import FluidBackend
from rigidfluid.core.model.ranks import Ranks
from rigidfluid.core.model.reduced_model import Coupling
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose
from rigidfluid.core.output.checkpoint import Checkpoint
from rigidfluid.core.output.extremes import Extremes
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import records
from rigidfluid.core.output.writer import CHECKPOINT, Writer, earlier_run
from rigidfluid.core.run.clock import Clock
from rigidfluid.core.run.step import CLOSEST_APPROACH, WIDEST_OPENING, attempt, bodies_energy, contact_energy
from rigidfluid.core.run.stopwatch import Stopwatch
from rigidfluid.core.run.summary import summarise
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.build import build_system
from rigidfluid.errors import OutputError, SceneError, StepError, StepRejected

MOST_ATTEMPTS = 4
"""Path and fluid of a step with contacts follow each other so many times at most; two are usual."""

START_LEVEL = 6
"""In a fluid in motion the first step is the step halved so many times, and each later one at most twice the last."""


@dataclass(frozen=True, slots=True)
class Progress:
    """Where a run is: ``time`` of ``end`` [time], latest ``step`` [time], smallest ``gap`` [length], wall seconds."""

    time: float
    end: float
    step: float
    gap: float
    elapsed: float


class Simulation:
    """A run in progress: the latest accepted state, and all that it takes to reach the next one.

    Parameters
    ----------
    scene : Scene
        What to run.
    out : Path or None
        Folder for the results, or None.
    resume : bool
        Whether to go on from the checkpoint there.
    processes : int or None
        How many processes were started to share the run; None if the backend's own ranks are those.
    """

    def __init__(self, scene: Scene, out: Path | None, resume: bool, processes: int | None = None) -> None:
        self.scene = scene
        self.system = build_system(scene)
        self._ranks = self.system.backend.ranks
        _refuse_lone_ranks(self.system.backend, processes)
        earlier = _earlier(scene, out, self._ranks) if resume else None
        self.clock = Clock.for_steps(scene.time.step, scene.time.shortest, scene.time.end)
        sizes = _sizes(scene, self.system)
        quality = scene.mesh.quality if scene.mesh else 0.0
        self.mover = Mover(self.system, sizes, quality, self.clock.ticks(0))
        self.watch = Stopwatch()
        self.history = History(scene.dimension, folder=out)
        self.extremes = Extremes.none(len(self.system.bodies))
        self._probes = np.array(scene.output.probes, dtype=float).reshape(-1, scene.dimension)
        self._start = time.perf_counter()
        self._writer: Writer | None = None
        try:
            if earlier is None:
                self._begin(out)
            else:
                assert out is not None
                self._take_up(out, earlier)
        except BaseException:
            self.close()
            raise

    @property
    def alone(self) -> bool:
        """Whether no other process shares the run."""
        return self._ranks.size == 1

    @property
    def elapsed(self) -> float:
        """Wall seconds of this run, those before a resumption included."""
        return self._elapsed_before + time.perf_counter() - self._start

    def go(self, progress: Callable[[Progress], None] | None) -> None:
        """Step until the end."""
        while self.state.tick < self.clock.last_tick:
            self._advance()
            self._record()
            if self._output_due():
                self._output()
            if progress is not None:
                now, level = self.clock.time(self.state.tick), self.state.level or 0
                progress(Progress(now, self.clock.end, self.clock.size(level), self._smallest_gap(), self.elapsed))

    def finish(self, status: str) -> None:
        """Sum up, in memory and on disk."""
        self.history.summary = summarise(self, status)
        self.history.summary["files"] = [] if self._writer is None else self._writer.files
        if self._writer is not None:
            self._writer.summary(self.history.summary)

    def close(self) -> None:
        """Let other runs write to the folder; nothing may be written after that."""
        if self._writer is not None:
            self._writer.close()

    def _begin(self, out: Path | None) -> None:
        self._elapsed_before = 0.0
        self.rejected, self.remeshes, self.failed_remeshes, self.unsettled = 0, 0, 0, 0
        self._times: tuple[float, ...] = ()
        with self.watch("mesh"):
            self.state = _initial_state(self.system, self.mover, self.clock)
        if self._ranks.shared(out is not None and (out / CHECKPOINT).exists()):
            self._rehearse()
        self._writer = None if out is None else Writer(out, self.scene.dimension, None, self._ranks)
        self._record()
        self._output()

    def _rehearse(self) -> None:
        """Try the first step before an earlier run's results are replaced; a scene that cannot start leaves them."""
        start = self.state
        self._advance()
        self.state = start
        self.rejected, self.remeshes, self.failed_remeshes, self.unsettled = 0, 0, 0, 0

    def _take_up(self, out: Path, earlier: Checkpoint) -> None:
        self.state = earlier.state
        self._elapsed_before = earlier.elapsed
        self.rejected, self.unsettled = earlier.rejected, earlier.unsettled
        self.remeshes, self.failed_remeshes = earlier.remeshes, earlier.failed_remeshes
        self._times = earlier.times
        self.watch.seconds = dict(earlier.seconds)
        self.extremes = earlier.extremes
        self._writer = Writer(out, self.scene.dimension, earlier, self._ranks)

    def _advance(self) -> None:
        """One accepted step: the longest that is allowed, halved until it succeeds."""
        level, path = self._first_level()
        while True:
            try:
                path = path or self._path(level)
                self._accept_mesh(path.pose)
                self.state, agreed = self._tried(level, path)
            except StepRejected as rejection:
                self.rejected += 1
                level, path = level + 1, None
                if level > self.clock.levels:
                    raise self._stuck(rejection) from rejection
            else:
                self.unsettled += not agreed
                return

    def _accept_mesh(self, pose: Pose) -> None:
        """The present state on a new mesh, if a step to ``pose`` asks for one; it is as good where that is rejected."""
        with self.watch("mesh"):
            state = self.mover.adapted(self.state, pose)
        self.remeshes += state.mesh is not self.state.mesh
        self.failed_remeshes += state.remesh_failed not in (None, self.state.remesh_failed)
        self.state = state

    def _tried(self, level: int, path: BodiesPath) -> tuple[State, bool]:
        """The state one step of this level later, and whether path and fluid agree there; nothing is changed."""
        for number in range(MOST_ATTEMPTS):
            candidate, step = attempt(self.system, self.clock, self.mover, self.watch, self.state, level, path)
            if level < self.clock.levels and unforeseen(self.system, self.state, candidate):
                raise _too_fast()
            if path.coupling is None:
                if number > 0 or self.state.past is not None or self.state.mesh is None:
                    return candidate, True
                path = first_step_again(self.state, candidate.twist, self.clock.size(level))
                continue
            with self.watch("response"):
                found = shown_coupling(self.system, self.state, candidate, path, step)
            agreed = settled(found, path, self.state, candidate)
            if agreed or number == MOST_ATTEMPTS - 1:
                break
            path = self._path(level, found)
            if level < self.clock.levels and self._changes_gaps_too_fast(path.pose):
                raise _too_fast()
        return replace(candidate, coupling=found), agreed

    def _path(self, level: int, coupling: Coupling | None = None) -> BodiesPath:
        """The bodies' way through a step, with a ``coupling`` that an attempt has shown or else the expected one."""
        time, size = self.clock.time(self.state.tick), self.clock.size(level)
        if coupling is None:
            with self.watch("response"):
                coupling = expected_coupling(self.system, self.state, time, size)
        with self.watch("contact"):
            return follow(self.system, self.state, time, size, coupling)

    def _first_level(self) -> tuple[int, BodiesPath | None]:
        """The longest step on the clock's grid that changes no gap too fast for the mesh, and the way it takes."""
        level = self.clock.longest_level(self.state.tick, self.state.level)
        while level < self.clock.levels:
            try:
                path = self._path(level)
            except StepRejected:
                break
            if not self._changes_gaps_too_fast(path.pose):
                return level, path
            level += 1
        return level, None

    def _changes_gaps_too_fast(self, pose: Pose) -> bool:
        """Whether the mesh in a gap would be squeezed, or a film opened, by more than a step can follow."""
        if self.state.mesh is None:
            return False
        moved = travel(self.system, self.state.pose, pose)
        before = least_gaps(self.system, self.state.pose, self.state.gaps)
        if np.all(moved + moved.max() <= (1.0 - CLOSEST_APPROACH) * before):
            return False  # too far away for that: no need to measure
        try:
            mesh = self.mover.moved(self.state, pose) if self.system.detector.needs_mesh else None
        except StepRejected:
            return True
        with self.watch("detect"):
            _, gaps = surroundings(self.system, pose, mesh)
        film = self.state.gaps < (self.system.law.range if self.system.law else 0.0)
        opens = film & (gaps > WIDEST_OPENING * self.state.gaps)
        return bool((gaps < CLOSEST_APPROACH * before).any() or opens.any())

    def _smallest_gap(self) -> float:
        return float(self.state.gaps.min())

    def _record(self) -> None:
        now = records(self.system, self._probes, self.state, self.clock.time(self.state.tick))
        self.history.extend(now)
        self.extremes = self.extremes.after(self.state.gaps, self.state.twist)
        if self._writer is not None:
            with self.watch("write"):
                self._writer.extend(now)

    def _output_due(self) -> bool:
        every = self.scene.output.every
        latest = math.floor(self._times[-1] / every + 1e-9)
        return self.state.tick >= min(self.clock.tick_from((latest + 1) * every), self.clock.last_tick)

    def _output(self) -> None:
        """Write fields and a checkpoint; the backend's caches go in any case, so that no result depends on writing."""
        self._times = (*self._times, self.clock.time(self.state.tick))
        self.system.backend.forget()
        if self._writer is None:
            return
        with self.watch("write"):
            if self.state.mesh is not None:
                self._writer.fields(self.system.backend.fields(self.state.fluid, self.state.mesh), self._times)
            self._writer.checkpoint(self._checkpoint(self._writer))

    def _checkpoint(self, writer: Writer) -> Checkpoint:
        return Checkpoint(
            state=self.state,
            scene=json.dumps(self.scene.to_dict()),
            times=self._times,
            lengths=writer.lengths,
            seconds=self.watch.seconds,
            rejected=self.rejected,
            unsettled=self.unsettled,
            remeshes=self.remeshes,
            failed_remeshes=self.failed_remeshes,
            elapsed=self.elapsed,
            extremes=self.extremes,
            ranks=self._ranks.size,
        )

    def _stuck(self, rejection: StepRejected) -> StepError:
        shortest, nearest = self.clock.size(self.clock.levels), int(np.argmin(self.state.gaps))
        body, gap = self.system.surfaces[nearest], self.state.gaps[nearest]
        return StepError(
            f"{rejection.subject} at time {self.clock.time(self.state.tick):g}",
            f"{rejection.found}, even with a step of {shortest:g}; body {body} is {gap:.3g} from the nearest surface",
            rejection.allowed,
            f"{rejection.remedy} What was computed until then is kept, and --resume goes on from the last output.",
        )


def _too_fast() -> StepRejected:
    found = (
        f"a gap that closes to less than {CLOSEST_APPROACH} of it, a film that opens more than {WIDEST_OPENING}-fold"
    )
    found += " or a contact that was out of sight"
    return StepRejected("the step", found, "slower changes", "Shorten time.step.")


def _initial_state(system: System, mover: Mover, clock: Clock) -> State:
    zero = nothing(system.pose)
    mesh = mover.first_mesh()
    contacts, gaps = surroundings(system, system.pose, mesh)
    fluid, kinetic = system.backend.initial(mesh, system.pose, system.twist)
    kinetic += bodies_energy(system, system.pose, system.twist)
    stored = contact_energy(system, contacts)
    return State(
        tick=0,
        count=0,
        level=_start_level(system, clock, stored),
        pose=system.pose,
        twist=system.twist,
        past=None,
        mesh=mesh,
        reference=None if mesh is None else reference_of(mesh, system.pose, gaps, 0),
        fluid=fluid,
        contacts=contacts,
        coupling=None,
        gaps=gaps,
        hydrodynamic_wrench=zero,
        contact_wrench=zero,
        ledger=Ledger(kinetic, stored, kinetic + stored),
    )


def _start_level(system: System, clock: Clock, stored: float) -> int | None:
    """The level that the first step may be twice as long as; any where the motion starts smoothly.

    Bodies that start with a velocity set the fluid in motion at once, but for a layer on them that spreads fast; so do
    contacts that let go, and weight where the fluid has no inertia.
    """
    problem = system.backend.problem
    if not system.backend.needs_mesh or problem is None:
        return None
    moves = system.twist.velocity.any() or system.twist.angular_velocity.any()
    at_once = moves or stored > 0.0 or (not problem.inertia and system.weight.any())
    return min(START_LEVEL + 1, clock.levels) if at_once else None


def _sizes(scene: Scene, system: System) -> Sizes | None:
    if not system.backend.needs_mesh:
        return None
    assert scene.mesh is not None
    m = scene.mesh
    return Sizes(m.size, m.size_body, m.growth, m.cells_per_gap, m.refinements)


def _refuse_lone_ranks(backend: FluidBackend, processes: int | None) -> None:
    if processes not in (None, backend.ranks.size):
        raise SceneError(
            "fluid.backend",
            f"{backend.name!r}, which runs in {backend.ranks.size}, and {processes} processes",
            "as many processes as the backend shares a run among",
            "Start one process, without mpirun, or choose a backend for several, such as 'dolfinx'.",
        )


def _earlier(scene: Scene, out: Path | None, ranks: Ranks) -> Checkpoint:
    """The checkpoint to resume; its scene must be this one, but for the end of time."""
    if out is None:
        raise OutputError("resume", "no folder", "the folder of an earlier run", "Name it with --out.")
    checkpoint = earlier_run(out, ranks)
    stored, given = json.loads(checkpoint.scene), scene.to_dict()
    stored["time"]["end"] = given["time"]["end"]
    if stored != given:
        changed = sorted(table for table in stored.keys() | given.keys() if stored.get(table) != given.get(table))
        raise OutputError(
            str(out),
            f"a run of another scene (other: {', '.join(changed)})",
            "a run of the same scene; only time.end may differ",
            "Give the same scene and the same --set, or run without --resume.",
        )
    return checkpoint
