"""The files of a run's folder as arrays, checked as they are read."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rigidfluid.core.case.load import scene_of_results
from rigidfluid.core.case.population import Population, assemble_ever
from rigidfluid.core.case.scene_model import model_of
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.field_images import continued
from rigidfluid.core.output.records import columns, moving, quantity_columns
from rigidfluid.core.output.results_folder import is_being_written
from rigidfluid.core.output.run_document import read_changes, read_document
from rigidfluid.core.output.run_files import RUN
from rigidfluid.core.output.tables import table_path
from rigidfluid.core.output.vtu import INSIDES, read_insides, read_pvd, read_vtu
from rigidfluid.core.output.writer import SERIES, SUMMARY
from rigidfluid.core.setup.assemble import assemble
from rigidfluid.core.setup.description import refuse_description
from rigidfluid.core.setup.model import Model
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.state_tables import changing_bodies, checked_rows, nobody_by_state, table_by_state
from rigidfluid.post.reports.units import Units

NEEDED = (
    *("scene", "status", "versions", "time", "steps", "rejected_steps", "remeshes", "cells", "unknowns"),
    *("failed_remeshes", "latest_failed_remesh"),
    *("wall_time", "wall_time_per_stage", "reynolds_solid_density", "reynolds", "smallest_gap"),
    *("rest_position", "energy"),
)
"""Keys that the page takes from summary.json."""


@dataclass(frozen=True)
class Results:
    """A run read back: s states of n bodies, all that were ever there.

    ``summary`` as in summary.json, empty where there is none; ``model`` and ``system`` as the run built them; ``time``
    (s,) [time]; ``bodies`` by column (s, n), where a body is not there not a number, with an infinite gap; ``joints``
    by column (s, j), no columns without any; ``energy`` by column (s,); ``series`` the times and files of the fields,
    empty without a fluid. ``wholes`` of mechanisms by column (s, mechanisms). ``contact_counts`` (s,): how many
    contacts there are within the range of the laws. ``written``: when its latest row was [s since 1970]. ``goes_on``:
    whether a process is writing there, in the ``folder``.
    """

    summary: dict[str, Any]
    model: Model
    system: System
    time: FloatArray
    bodies: dict[str, FloatArray]
    energy: dict[str, FloatArray]
    series: tuple[tuple[float, Path], ...]
    joints: dict[str, FloatArray] = field(default_factory=dict)
    wholes: dict[str, FloatArray] = field(default_factory=dict)
    contact_counts: FloatArray = field(default_factory=lambda: np.zeros(0))
    written: float = 0.0
    goes_on: bool = False
    folder: Path = Path()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the bodies."""
        return self.system.surfaces[: len(self.system.bodies)]

    @property
    def present(self) -> BoolArray:
        """Which bodies are there, at each state (s, n)."""
        return np.isfinite(self.bodies["x"])

    @property
    def units(self) -> Units:
        """Names of units, if the scene has any."""
        return Units.told_in(self.model.document)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of joints, and of bodies that are held or on springs."""
        return _joint_names(self.system)

    @property
    def axes(self) -> str:
        """The coordinates' names, ``xy`` or ``xyz``."""
        return "xyz"[: self.system.dimension]

    @property
    def outputs(self) -> tuple[tuple[float, Path | None], ...]:
        """Output times and the files of their fields, None without a fluid."""
        if self.series:
            return self.series
        times = np.arange(self.time[0], self.time[-1] + 1e-9, self.model.output.every)
        return tuple((float(time), None) for time in times)

    def state_at(self, time: float) -> int:
        """Number of the state nearest to a time."""
        return int(np.argmin(np.abs(self.time - time)))

    def number_of(self, name: str) -> int:
        """Number of the body of that name; raises OutputError if there is none."""
        if name not in self.names:
            raise OutputError("--follow", name, f"a body: {', '.join(self.names[:20])}", "Name one of them.")
        return self.names.index(name)

    def quantity(self, name: str) -> FloatArray:
        """One of the `quantity_columns` of all bodies, its components last, (s, n, d), (s, n, k) or (s, n, q)."""
        return np.stack([self.bodies[column] for column in quantity_columns(self.system.dimension)[name]], axis=-1)

    def fields(self, path: Path) -> Fields:
        """Fields in a file, along periods of all cells in the domain, in which the mesh itself need not be."""
        return continued(read_vtu(path), self.system.lattice)

    def insides(self, path: Path) -> Fields | None:
        """Scalar inside bodies that conduct, at the time of a file of fields, continued like these; velocity and
        pressure are not numbers there. None where no body conducts."""
        beside = path.with_suffix(f".{INSIDES}.vtu")
        if not beside.exists():
            return None
        inside = read_insides(beside)
        velocity = np.full_like(inside.points, np.nan)
        return continued(
            Fields(inside.points, inside.cells, velocity, velocity[:, 0], inside.scalar), self.system.lattice
        )

    def path(self, body: int) -> FloatArray:
        """Positions of a body by number (s, d), along periods those of its image in the domain; its first before it
        enters, its last after it has left; the middle of the domain in a run without bodies [length]."""
        if not self.names:
            return np.tile(np.mean(self.system.domain.extent, axis=0), (len(self.time), 1))
        there = np.flatnonzero(self.present[:, body])
        state = np.clip(np.arange(len(self.time)), there[0], there[-1])
        return self.system.domain.wrapped(self.quantity("position")[state, body])


def read_results(folder: Path, *, motion_only: bool = False, model: Model | None = None) -> Results:
    """Read a run's folder, all but the fields themselves, which are read one by one.

    With ``motion_only`` energies, joints and contacts are left out. A run that was killed or goes on has no summary:
    it is read as far as all its tables are. A run of a model made in Python wants the ``model``. Raises OutputError
    that names a missing or unreadable file; SceneError or PluginError if the run's scene cannot be built here, as
    without one of its plug-ins.
    """
    summary, told = read_document(folder, NEEDED)
    complete, changes = bool(summary), read_changes(folder, summary)
    series = read_pvd(folder / SERIES) if (folder / SERIES).exists() else ()  # before tables, which may grow
    model = _model(told, folder) if model is None else _same(model, told, folder)
    population = Population.from_dict(changes)
    tables: dict[str, dict[str, FloatArray]] = {}
    if population:
        wide = columns(model.dimension, periodic=bool(model.domain.periodic))
        names, tables["bodies"] = changing_bodies(folder, wide, population.known(model), complete=complete)
        system = assemble_ever(model := population.ever(model, names))
    else:
        system = assemble(model)
    count, links = len(system.bodies), len(_joint_names(system))
    bodies = len(moving(system))
    wanted = {"bodies": bodies} | ({} if motion_only and bodies else {"energy": 1, "joints": links})
    tables |= {
        name: table_by_state(folder, name, system, each, complete=complete)
        for name, each in wanted.items()
        if each > 0 and name not in tables
    }
    whole = min(len(table["step"]) for table in tables.values())
    if not complete:
        tables = {name: {key: values[:whole] for key, values in table.items()} for name, table in tables.items()}
    stamps = tables["bodies" if bodies else "energy"]
    by_state = tables["bodies"] if bodies else nobody_by_state(model.dimension, len(stamps["time"]))
    steps = stamps["step"][:, 0]
    return Results(
        summary=summary,
        model=model,
        system=system,
        time=stamps["time"][:, 0],
        bodies={name: values[:, :count] for name, values in by_state.items()},
        joints=tables.get("joints", {}),
        energy={name: values[:, 0] for name, values in tables.get("energy", {}).items()},
        series=series,
        wholes={name: values[:, count:] for name, values in by_state.items()},
        goes_on=is_being_written(folder, RUN),
        folder=folder,
        written=table_path(folder, "bodies").stat().st_mtime,
        contact_counts=np.zeros(0) if motion_only else _contact_counts(folder, model.dimension, steps),
    )


def _same(model: Model, told: dict[str, Any], folder: Path) -> Model:
    if model.document != told:
        remedy = "Give the model that made them."
        raise OutputError(str(folder), "results of another model", f"those of {model.name!r}", remedy)
    return model


def _model(tables: dict[str, Any], folder: Path) -> Model:
    remedy = "Give the model in Python, to report(folder, model=model) or movie(folder, model=model)."
    refuse_description(tables, folder, remedy)
    return model_of(scene_of_results(tables))


def _contact_counts(folder: Path, dimension: int, steps: FloatArray) -> FloatArray:
    """Count of rows in the table of contacts for each of the ``steps`` (s,), which rise; there may be later ones."""
    path, names = folder / "contacts.csv", columns(dimension)["contacts"]
    rows = checked_rows(path, names, may_be_empty=True, complete=(folder / SUMMARY).exists())
    at_contacts = np.array([row[names.index("step")] for row in rows], dtype=float)
    known = np.searchsorted(steps, at_contacts[at_contacts <= steps[-1]])
    return np.bincount(known, minlength=len(steps)).astype(float)


def _joint_names(system: System) -> tuple[str, ...]:
    force = system.joints.unloaded(system.motions.pose).force
    return tuple(one.name for one in system.joints.readings(system.pose, system.twist, 0.0, force))
