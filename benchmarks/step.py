"""One accepted step beside P2–P1 steps of NGSolve on the same meshes, in one run: CPU seconds of one thread.

Ours: move the mesh, detect, assemble, solve for fluid and body, measure energies; nothing is written; factors are
renewed as in any run, and their share is in the mean. NGSolve's: assemble on the same meshes with the same motion of
the body, and solve, in the three ways of `ngsolve_step`.

    python benchmarks/step.py [--steps 40] [--sizes 15 45 150] [--json FILE] [--page FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any
from unittest.mock import patch

from disk_under_way import MESHES, falling
from ngsolve_step import RENEWED_EVERY, WAYS, Frame, time_ngsolve
from stages import measured
from threadpoolctl import threadpool_limits
from written_page import measurement, write_page

from rigidfluid.core.run.simulation import Simulation

AIMS = {"imex": 0.35, "reuse": 0.5}
"""Ratios to these ways at 45,000 unknowns that rigidfluid is to stay below."""


def compare(thousands: int, steps: int) -> dict[str, Any]:
    """One row: all on the same meshes, one after the other."""
    run, frames = falling(thousands), list[Frame]()
    mesh, problem = run.state.mesh, run.system.fluid
    assert mesh is not None
    assert problem is not None

    def keep(now: Simulation) -> None:
        if now.state.mesh is not None and now.state.mesh.cells is mesh.cells:
            frames.append(Frame(now.state.mesh.points, now.state.twist.velocity[0]))

    run.observe(keep)
    # All clocks of the benchmark and of the run's own stages count CPU seconds.
    with patch.object(time, "perf_counter", time.process_time), threadpool_limits(limits=1):
        ours = measured(run, steps)
        few = frames[: max(3, steps // 10)]
        theirs = {
            way: time_ngsolve(mesh, problem, run.clock.size(0), way, frames if way == "reuse" else few) for way in WAYS
        }
    seconds = {way: sum(stages.values()) for way, (stages, _) in theirs.items()}
    return {
        "unknowns": run.system.backend.unknowns(mesh, run.system.prescribed),
        "cells": len(mesh.cells),
        "seconds": ours["seconds"],
        "stages": ours["stages"],
        "ngsolve_unknowns": theirs[WAYS[0]][1],
        "ngsolve_seconds": seconds,
        "ngsolve_stages": {way: stages for way, (stages, _) in theirs.items()},
        "ratio": {way: ours["seconds"] / seconds[way] for way in WAYS},
    }


def show(row: dict[str, Any]) -> None:
    """Print one row and all profiles."""
    print(f"\n{row['unknowns']} unknowns, {row['cells']} cells (NGSolve: {row['ngsolve_unknowns']} unknowns)")
    print(f"  rigidfluid {1000 * row['seconds']:.1f} ms a step")
    for way in WAYS:
        print(f"  NGSolve {way} {1000 * row['ngsolve_seconds'][way]:.1f} ms: ratio {row['ratio'][way]:.2f}")
    for title, stages in (("rigidfluid", row["stages"]), *row["ngsolve_stages"].items()):
        for stage, seconds in sorted(stages.items(), key=lambda item: -item[1]):
            print(f"    {title:12s} {stage:36s} {1000 * seconds:9.2f} ms")


PREAMBLE = """\
Made on {date} by `python benchmarks/step.py --page docs/validation/step.md`, load of the machine {load:.1f} on {cores}
cores. CPU milliseconds of one thread for a step of the falling disk. Only the ratios of one run mean something.

NGSolve takes its steps on the same meshes, with the body's motion given, in three ways:

* `umfpack`: convection by the latest velocity, UMFPACK at each step, as the first examples do;
* `imex`: convection explicit and integrands compiled, so that sparsecholesky can factorise the matrix at each step;
* `reuse`: as `imex`, with factors of up to {renewed} steps ago as preconditioner of GMRES, to a residual of 1e-9.

rigidfluid's step is implicit in the convection too, and includes moving the mesh, detection, the motion of the body and
the energy balance. At 45,000 unknowns its aims are {imex} of `imex` and {reuse} of `reuse`; NGSolve has
straight cells.
"""


def page(found: dict[str, Any]) -> str:
    """The rows as a Markdown page with their date, command and load."""
    rows = found["rows"]
    preamble = PREAMBLE.format(
        date=found["date"], load=found["load"], cores=found["cores"], renewed=RENEWED_EVERY, **AIMS
    )
    ways = " | ".join(f"{way} [ms] | ratio" for way in WAYS)
    lines = [
        "# One step beside NGSolve",
        "",
        preamble,
        f"| unknowns | rigidfluid [ms] | {ways} |",
        "|---" * (2 + 2 * len(WAYS)) + "|",
    ]
    for row in rows:
        theirs = " | ".join(f"{1000 * row['ngsolve_seconds'][way]:.0f} | {row['ratio'][way]:.2f}" for way in WAYS)
        lines.append(f"| {row['unknowns']} | {1000 * row['seconds']:.0f} | {theirs} |")
    lines += [
        "",
        "| stage [ms] | " + " | ".join(str(row["unknowns"]) for row in rows) + " |",
        "|---" * (len(rows) + 1) + "|",
    ]
    profiles = [("", [row["stages"] for row in rows])]
    profiles += [(f"NGSolve {way}: ", [row["ngsolve_stages"][way] for row in rows]) for way in WAYS]
    for title, of_rows in profiles:
        for stage in of_rows[0]:
            figures = " | ".join(f"{1000 * stages.get(stage, 0.0):.1f}" for stages in of_rows)
            lines.append(f"| {title}{stage} | {figures} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the arguments, measure, print, and write the figures where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--sizes", type=int, nargs="+", default=[15, 45, 150], choices=list(MESHES))
    parser.add_argument("--json", type=Path)
    parser.add_argument("--page", type=Path, help="write a Markdown page here")
    parser.add_argument("--kept", action="store_true", help="write the page of what is kept, and measure nothing")
    arguments = parser.parse_args()
    rows = []
    for thousands in [] if arguments.kept else arguments.sizes:
        rows.append(compare(thousands, arguments.steps))
        show(rows[-1])
    if arguments.page:
        write_page(arguments.page, page(measurement(arguments.page, rows or None)), kept=arguments.kept)
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
