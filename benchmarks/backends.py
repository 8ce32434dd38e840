"""One accepted step of the falling disk with each fluid backend: time by stage, growth with size, memory.

Each measurement is a process of its own, or two that share a run, one after the other. A backend that is not installed
is left out, with the reason.

    python benchmarks/backends.py [--steps 20] [--sizes 15 45 150 600] [--backends …] [--json FILE] [--page FILE]
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from disk_under_way import MESHES, OUTPUT_EVERY, falling
from processes import measured_apart
from stages import STAGES, measured
from written_page import measurement, write_page

from rigidfluid.core.run.process import one_openblas_thread, peak_memory
from rigidfluid.errors import RigidfluidError
from rigidfluid.registry import FLUID_BACKEND, Registry

ROOT = Path(__file__).resolve().parents[1]
SMALLEST = min(MESHES)  # thousands of unknowns: compiles, not reported
BACKENDS = ("scikit-fem", "ngsolve", "dolfinx")
SHARED = ("dolfinx",)  # as many ranks as cores; the others as many threads
CORES = (1, 2)


@dataclass(frozen=True)
class Case:
    """A backend on some cores."""

    backend: str
    cores: int

    @property
    def name(self) -> str:
        """For people."""
        kind = "rank" if self.backend in SHARED else "thread"
        return f"{self.backend}, {self.cores} {kind}{'s' * (self.cores > 1)}"

    def measure(self, thousands: int, steps: int) -> dict[str, Any]:
        """In processes of its own."""
        ranks, threads = (self.cores, 1) if self.backend in SHARED else (1, self.cores)
        found: dict[str, Any] = measured_apart(
            [__file__, "--child", self.backend, str(thousands), str(steps)], ranks, threads
        )
        return found


def child(backend: str, thousands: int, steps: int, file: Path) -> None:
    """Measure in this process, or in those that share its run."""
    with one_openblas_thread():
        run = falling(thousands, backend)
        found = measured(run, steps)
    mesh, ranks = run.state.mesh, run.system.backend.ranks
    assert mesh is not None
    found["unknowns"] = run.system.backend.unknowns(mesh, run.system.prescribed)
    found["memory"] = int(ranks.sum(peak_memory() or 0))
    if ranks.is_root:
        file.write_text(json.dumps(found), encoding="utf-8")


def missing(backend: str) -> str:
    """Why a backend cannot be measured here, or nothing."""
    try:
        Registry.load().get(FLUID_BACKEND, backend)
    except RigidfluidError as error:
        return str(error)
    return ""


def exponent(unknowns: Sequence[int], values: Sequence[float]) -> float | None:
    """k of the power law value ~ unknownsᵏ by least squares of logarithms; None of fewer than two values above 0."""
    pairs = [(n, value) for n, value in zip(unknowns, values, strict=True) if value > 0]
    if len(pairs) < 2:
        return None
    n, value = np.log(np.array(pairs)).T
    return float(np.polyfit(n, value, 1)[0])


def collect(cases: Sequence[Case], sizes: Sequence[int], steps: int) -> dict[str, Any]:
    """All measurements by the case's name, and why others are not there."""
    rows: dict[str, list[dict[str, Any]]] = {}
    skipped: dict[str, str] = {}
    for case in cases:
        if reason := missing(case.backend):
            skipped[case.name] = reason
            continue
        try:
            case.measure(SMALLEST, 2)
            rows[case.name] = []
            for thousands in sizes:
                rows[case.name].append(case.measure(thousands, steps))
                show(case.name, rows[case.name][-1])
        except RigidfluidError as error:
            skipped[case.name] = str(error)
    return {
        "date": str(datetime.date.today()),
        "machine": f"{os.cpu_count()} cores, {platform.machine()}, Python {platform.python_version()}",
        "steps": steps,
        "rows": {name: found for name, found in rows.items() if found},
        "skipped": skipped,
    }


def show(name: str, row: Mapping[str, Any]) -> None:
    """Print one measurement."""
    print(
        f"{name}: {row['unknowns']} unknowns, {row['seconds']:.4f} s a step, {row['memory'] / 2**20:.0f} MiB", end=": "
    )
    print(", ".join(f"{stage} {1000 * seconds:.1f} ms" for stage, seconds in row["stages"].items()), flush=True)


PREAMBLE = """\
# Fluid backends side by side

Made on {date} on {machine}, by

```
{command}
```

Mean of {steps} steps of the [falling disk](falling_disk.md) under way, on the same meshes; the factors are dropped once
in {every} steps, as an output does. A thread or rank is a core. Of ranks the times are means over them and the memory
is their sum; memory is the highest of the whole process, meshing and compiled code included. The exponent k is that of
time ~ unknownsᵏ, by least squares of the logarithms. Times of other days and machines are not to be compared.

![Seconds a step against unknowns](backends.png)
"""


def page(found: Mapping[str, Any]) -> str:
    """The measurements as a Markdown page."""
    told = found["rows"]
    parts = [PREAMBLE.format(**told, every=OUTPUT_EVERY)]
    parts += [f"## {name}\n\n{table(rows)}\n" for name, rows in told["rows"].items()]
    if told["skipped"]:
        left_out = "\n".join(f"* {name}: {reason}" for name, reason in told["skipped"].items())
        parts.append(f"## Not measured\n\n{left_out}\n")
    return "\n".join(parts)


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """One case: stages by sizes, with exponents."""
    unknowns = [row["unknowns"] for row in rows]

    def line(title: str, values: Sequence[float], digits: int, last: str = "") -> str:
        return f"| {title} | " + " | ".join(f"{value:.{digits}f}" for value in values) + f" | {last} |"

    def timed(title: str, seconds: Sequence[float]) -> str:
        growth = exponent(unknowns, seconds)
        return line(title, [1000 * value for value in seconds], 1, "" if growth is None else f"{growth:.2f}")

    return "\n".join(
        [
            f"| [ms a step] | {' | '.join(map(str, unknowns))} | exponent |",
            "|---" * (len(rows) + 2) + "|",
            timed("**whole step**", [row["seconds"] for row in rows]),
            *(timed(stage, [row["stages"][stage] for row in rows]) for stage in STAGES),
            line("Krylov iterations a step", [row["iterations"] for row in rows], 2),
            line("factorisations in all", [row["factorisations"] for row in rows], 0),
            line("peak memory [MiB]", [row["memory"] / 2**20 for row in rows], 0),
        ]
    )


def plot(found: Mapping[str, Any], file: Path) -> None:
    """Seconds a step against unknowns, a line for each case."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.subplots()
    for name, rows in found["rows"].items():
        unknowns, seconds = [row["unknowns"] for row in rows], [row["seconds"] for row in rows]
        growth = exponent(unknowns, seconds)
        axes.loglog(unknowns, seconds, "o-", label=name if growth is None else f"{name}: exponent {growth:.2f}")
    axes.set(xlabel="unknowns", ylabel="seconds a step", xticks=unknowns, xticklabels=unknowns)
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    figure.savefig(file, dpi=150)


def main() -> None:
    """Read the arguments, measure, print, and write what is asked for."""
    if sys.argv[1:2] == ["--child"]:
        backend, thousands, steps, file = sys.argv[2:]
        child(backend, int(thousands), int(steps), Path(file))
        return
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=OUTPUT_EVERY)
    parser.add_argument("--sizes", type=int, nargs="+", default=[15, 45, 150, 600], choices=list(MESHES))
    parser.add_argument("--backends", nargs="+", default=list(BACKENDS))
    parser.add_argument("--cores", type=int, nargs="+", default=list(CORES))
    parser.add_argument("--json", type=Path)
    parser.add_argument("--page", type=Path, help="write a Markdown page here, and a plot beside it")
    parser.add_argument("--kept", action="store_true", help="write the page of what is kept, and measure nothing")
    arguments = parser.parse_args()
    if arguments.kept:
        write(arguments.page, measurement(arguments.page), kept=True)
        return
    cases = [Case(backend, cores) for backend in arguments.backends for cores in arguments.cores]
    found = collect(cases, arguments.sizes, arguments.steps)
    for name, reason in found["skipped"].items():
        print(f"{name} left out: {reason}")
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    if arguments.page:
        found["command"] = told_command(sys.argv[1:])
        write(arguments.page, measurement(arguments.page, found))


def told_command(words: Sequence[str]) -> str:
    """The command with these words as one types it in the repository, wherever that lies."""
    return " ".join(["python benchmarks/backends.py", *(word.removeprefix(f"{ROOT}/") for word in words)])


def write(file: Path, found: Mapping[str, Any], *, kept: bool = False) -> None:
    """Write the page and its plot."""
    plot(found["rows"], file.with_suffix(".png"))
    write_page(file, page(found), kept=kept)


if __name__ == "__main__":
    main()
