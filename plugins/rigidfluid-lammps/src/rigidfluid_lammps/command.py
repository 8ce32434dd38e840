"""The command `rigidfluid crosscheck`; the only place that prints."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from rigidfluid.api import load_scene
from rigidfluid.commands import Assignments, JsonFile, SceneFile, write_json
from rigidfluid_lammps.comparison import Row
from rigidfluid_lammps.crosscheck import crosscheck as run_both

Steps = Annotated[int, typer.Option(help="Steps to run with: time.step over contact.substeps, half of it, …", min=1)]

DIFFERENCES = ("step", "position", "velocity", "spin", "energy", "momentum", "from_finest", "parted")
MEANS = ("step", "mean energy", "LAMMPS'", "momentum", "LAMMPS'", "pressure on walls", "LAMMPS'")


def crosscheck(scene: SceneFile, assignments: Assignments = None, json_file: JsonFile = None, steps: Steps = 3) -> None:
    """Run a dry scene of balls in LAMMPS too, and say how far the results are apart."""
    rows = run_both(load_scene(scene, assignments or ()), steps).rows
    differences = Table(*(column.replace("_", " ") for column in DIFFERENCES), title="largest differences from LAMMPS")
    means = Table(*MEANS)
    for row in rows:
        differences.add_row(*_differences(row))
        means.add_row(*_means(row))
    Console().print(differences, means)
    if json_file is not None:
        write_json([asdict(row) for row in rows], json_file)


def _differences(row: Row) -> list[str]:
    """Cells of the columns `DIFFERENCES`."""
    values = [getattr(row, column) for column in DIFFERENCES]
    return ["never" if value is None else f"{value:.1e}" for value in values]


def _means(row: Row) -> list[str]:
    """Cells of the columns `MEANS`: the step, and pairs of ours and theirs."""
    pairs = [(getattr(row.ours, name), getattr(row.theirs, name)) for name in ("energy", "momentum", "pressure")]
    return [f"{value:.4g}" for value in (row.step, *(value for pair in pairs for value in pair))]
