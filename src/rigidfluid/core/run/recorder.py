"""Records of a run: rows of each state, and fields, points and a checkpoint at each output."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from rigidfluid.core.coupling.contact_forces import contact_forces
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import FluidState
from rigidfluid.core.output.checkpoint import Checkpoint
from rigidfluid.core.output.extremes import Extremes
from rigidfluid.core.output.history import History
from rigidfluid.core.output.point_sets import point_sets
from rigidfluid.core.output.records import Records, Row, StepCost, count_cells, records
from rigidfluid.core.output.writer import Writer
from rigidfluid.core.run.companions import Companions
from rigidfluid.core.run.statistics_row import statistics_rows
from rigidfluid.errors import OutputError

if TYPE_CHECKING:
    from rigidfluid.core.run.simulation import Simulation


class Recorder:
    """Records of a run in memory, and in a folder once there is a writer to it.

    ``files`` are the digests of the files that the scene names, ``extremes`` those of gaps and velocities until now,
    ``probes`` (m, d) the points at which the flow is recorded.
    """

    def __init__(self, history: History, extremes: Extremes, files: Mapping[str, str], probes: FloatArray) -> None:
        self.history, self.extremes = history, extremes
        self._probes = probes
        self.companions = Companions()
        self._files = files
        self._times: tuple[float, ...] = ()
        self._writer: Writer | None = None

    @property
    def folder(self) -> Path | None:
        """Folder of the results, None of a run in memory."""
        return None if self._writer is None else self._writer.out

    def write_to(self, out: Path, simulation: Simulation, earlier: Checkpoint | None = None) -> None:
        """Write to a folder from now on, after what an ``earlier`` run has left there."""
        if earlier is not None:
            self._times, self.extremes = earlier.times, earlier.extremes
        self._writer = Writer(out, self.history.columns, earlier, simulation.system.backend.ranks)

    def record(self, simulation: Simulation) -> None:
        """Add the rows of the present state."""
        state = simulation.state
        forces = contact_forces(simulation.system, simulation.stepper.scheme, state, simulation.time)
        rows = records(simulation.system, self._probes, state, simulation.time, _cost(simulation), forces)
        if simulation.model.output.statistics:
            rows["statistics"] = statistics_rows(simulation.system, state, simulation.time, forces)
        self._extend({**rows, **self.companions.step_rows(simulation)}, simulation)
        self.extremes = self.extremes.after(state.gaps, state.twist)

    def record_exchange(self, rows: list[Row], simulation: Simulation) -> None:
        """Add the rows of bodies that entered and left between two states."""
        self._extend({"exchanges": rows}, simulation)

    def output(self, simulation: Simulation) -> None:
        """Write fields, points and a checkpoint; the backend is asked in any case: no result depends on writing."""
        self._times = (*self._times, simulation.time)
        self._extend(self.companions.output_rows(simulation), simulation)
        memory = simulation.system.backend.memory()
        if self._writer is None:
            return
        system, state = simulation.system, simulation.state
        with simulation.watch("write"):
            fields = simulation.fields() if count_cells(state.mesh) else None
            forces = contact_forces(system, simulation.stepper.scheme, state, simulation.time)
            self._writer.output(fields, point_sets(system, state, forces), self._times)
            self._writer.checkpoint(self._checkpoint(simulation, self._writer, memory))

    def finish(self, summary: dict[str, object]) -> None:
        """Keep the summary."""
        self.history.summary = {**summary, "files": [] if self._writer is None else self._writer.files}
        if self._writer is not None:
            self._writer.summary(self.history.summary)

    def refuse_closed(self, wanted: str) -> None:
        """Raise OutputError if the folder has been left to other runs."""
        if self._writer is not None and self._writer.closed:
            remedy = "Make another Simulation, with resume=True to go on."
            raise OutputError(str(self._writer.out), f"{wanted} after close()", f"{wanted} before it", remedy)

    def close(self) -> None:
        """Let other runs write to the folder."""
        if self._writer is not None:
            self._writer.close()

    def _extend(self, rows: Records, simulation: Simulation) -> None:
        self.history.extend(rows)
        if self._writer is not None:
            with simulation.watch("write"):
                self._writer.extend(rows)

    def _checkpoint(self, simulation: Simulation, writer: Writer, memory: FluidState) -> Checkpoint:
        return Checkpoint(
            state=simulation.state,
            memory=memory,
            scene=json.dumps(simulation.model.document),
            population=json.dumps(simulation.population.to_dict()),
            files=json.dumps(self._files),
            times=self._times,
            sizes=writer.sizes,
            tables=writer.tables,
            seconds=simulation.watch.seconds,
            **asdict(simulation.counts),
            elapsed=simulation.elapsed,
            cpu_time=simulation.cpu_time,
            extremes=self.extremes,
            ranks=simulation.system.backend.ranks.size,
        )


def _cost(simulation: Simulation) -> StepCost | None:
    """Cost of the step to the present state, None at the start."""
    state = simulation.state
    if state.count == 0 or state.level is None:
        return None
    quality = simulation.mesh_updater.quality(state)
    return StepCost(simulation.clock.size(state.level), simulation.counts.remeshes, quality)
