"""Error of the falling disk's passing times against CPU seconds: rigidfluid, an NGSolve script, stored OpenFOAM.

The error is the largest of three times, when the disk's centre passes y = 2, 1 and 0.5 cm, over the last of them.
Seconds are those of one thread for a whole command, start-up and output included, each in a process of its own.

    python benchmarks/work_precision.py [--page docs/validation/work_precision.md]
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.interpolate import CubicHermiteSpline
from written_page import measurement, write_page

from rigidfluid.python_process import ONE_THREAD

FOLDER = Path(__file__).parent
SCENE = FOLDER.parent / "scenes" / "falling_disk.toml"
STORED: dict[str, Any] = json.loads((FOLDER / "work_precision.json").read_text(encoding="utf-8"))
HEIGHTS = (2.0, 1.0, 0.5)  # cm
END = 0.712  # s, when the disk is below the last height in all runs
# (size_body [cm], step [s]) of rigidfluid; (size, growth, size_body, step) of the script: the best that were found, as
# its steps are bounded by the explicit convection, and a coarse mesh far from the disk makes them cheap.
OURS = ((0.05, 0.008), (0.025, 0.004), (0.0125, 0.002), (0.01, 0.001))
NGSOLVE = ((0.3, 0.3, 0.05, 0.005), (0.3, 0.2, 0.05, 0.004), (0.2, 0.2, 0.025, 0.003), (0.15, 0.2, 0.025, 0.002))


@dataclass(frozen=True)
class Row:
    """One run of a program: what it was set to, its error and its CPU seconds."""

    program: str
    settings: str
    error: float
    seconds: float


def passing_times(time: np.ndarray, height: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """When the disk passes `HEIGHTS`, by cubics through positions and velocities of each step."""
    way = CubicHermiteSpline(time, height, velocity)
    return np.array([way.solve(y, extrapolate=False)[0] for y in HEIGHTS])


def error_of(times: np.ndarray) -> float:
    """The largest distance from the reference over its last time."""
    reference = np.array(STORED["reference"]["passing_times"])
    return float(np.abs(times - reference).max() / reference[-1])


def cpu_seconds(command: Sequence[str]) -> float:
    """User and system seconds of a command on one thread."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env=os.environ | ONE_THREAD, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def ours(size_body: float, step: float) -> Row:
    """`rigidfluid run` with the scene as it ships but for the cells on the disk and the step."""
    with tempfile.TemporaryDirectory() as folder:
        settings = [f"mesh.size_body={size_body}", f"time.step={step}", f"time.end={END}"]
        overrides = [word for setting in settings for word in ("--set", setting)]
        seconds = cpu_seconds([sys.executable, "-m", "rigidfluid", "run", str(SCENE), "--out", folder, *overrides])
        with (Path(folder) / "bodies.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    columns = (np.array([float(row[name]) for row in rows]) for name in ("time", "y", "vy"))
    return Row("rigidfluid", f"{size_body:g}, {step:g}", error_of(passing_times(*columns)), seconds)


def ngsolve(size: float, growth: float, size_body: float, step: float) -> Row:
    """The script beside this file."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "fall.txt"
        script = str(FOLDER / "ngsolve_falling_disk.py")
        seconds = cpu_seconds([sys.executable, script, *map(str, (size, growth, size_body, step, table))])
        times = passing_times(*np.loadtxt(table).T)
    settings = f"{size_body:g}, {step:g} (far {size:g}, growth {growth:g})"
    return Row("NGSolve, a script", settings, error_of(times), seconds)


def measured() -> Iterator[Row]:
    """All runs, each as soon as it has ended; a first one, not reported, fills the caches on the disk."""
    ours(*OURS[0])
    for settings in OURS:
        yield ours(*settings)
    for settings in NGSOLVE:
        yield ngsolve(*settings)


def stored() -> list[Row]:
    """Rows that were measured before, elsewhere."""
    return [Row(one["name"], "stored", row["error"], row["seconds"]) for one in STORED["stored"] for row in one["rows"]]


def all_rows(found: dict[str, Any]) -> list[Row]:
    """Those that are measured together, and those from elsewhere."""
    return [*(Row(**row) for row in found["rows"]), *stored()]


def plot(rows: Sequence[Row], path: Path) -> None:
    """Error over seconds, both logarithmic."""
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot(
        xlabel="CPU seconds of one thread", ylabel="error of the passing times", xscale="log", yscale="log"
    )
    for program, style in zip(dict.fromkeys(row.program for row in rows), ("o-", "s-", "x:"), strict=True):
        of_it = [row for row in rows if row.program == program]
        axes.plot([row.seconds for row in of_it], [row.error for row in of_it], style, label=program)
    axes.grid(which="both", alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=120)


PAGE = """\
# Error against CPU seconds: the falling disk

Made on {date} by `python benchmarks/work_precision.py --page docs/validation/work_precision.md`, load of the machine
{load:.1f} on {cores} cores; seconds grow with it.

![Error against CPU seconds]({picture})

The error is that of the times at which the disk's centre passes y = 2, 1 and 0.5 cm, the largest of the three over the
last. Seconds are CPU seconds of one thread for the whole command, start-up and output included.

| program | size_body [cm], step [s] | error | CPU [s] |
|---|---|---|---|
{table}

* Reference: {reference}.
* NGSolve: `benchmarks/ngsolve_falling_disk.py`, what somebody would write for this one scene. It stretches the mesh in
  y, its convection is explicit, its cells at the disk are curved, and sparsecholesky factorises each step's matrix. It
  has no contacts, turning, sideways motion, re-meshing, energies or output of fields, and cannot go on to the floor.
  Its settings are the four best of nine that were tried. Errors below 2e-5 are not ranked: the programs agree so far.
{stored}
"""


def page(found: dict[str, Any], picture: str) -> str:
    """The page with its date, command and load."""
    rows = all_rows(found)
    return PAGE.format(
        date=found["date"],
        load=found["load"],
        cores=found["cores"],
        picture=picture,
        table="\n".join(f"| {row.program} | {row.settings} | {row.error:.1e} | {row.seconds:.1f} |" for row in rows),
        reference=STORED["reference"]["how"],
        stored="\n".join(f"* Stored, not measured with the others: {one['how']}." for one in STORED["stored"]),
    )


def main() -> None:
    """Measure, print, and write the page and its plot where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=Path, help="write a Markdown page here, and its plot beside it")
    parser.add_argument("--kept", action="store_true", help="write the page of what is kept, and measure nothing")
    arguments = parser.parse_args()
    rows = []
    for row in () if arguments.kept else measured():
        rows.append(asdict(row))
        print(f"{row.program:20s} {row.settings:14s} error {row.error:.2e}  {row.seconds:.1f} s", flush=True)
    if arguments.page:
        picture = arguments.page.with_suffix(".png")
        found = measurement(arguments.page, rows or None)
        plot(all_rows(found), picture)
        write_page(arguments.page, page(found, picture.name), kept=arguments.kept)


if __name__ == "__main__":
    main()
