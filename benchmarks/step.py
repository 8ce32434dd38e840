"""One accepted step beside the same-size P2–P1 step of NGSolve with UMFPACK, in one run.

Ours: move the mesh, detect, assemble, solve for fluid and body, measure energies; nothing is written; factors are
renewed as in any run, and their share is in the mean. NGSolve's: assemble the semi-implicit Navier–Stokes matrix on
the same mesh, factorise, solve, as one does on a mesh that moves at every step.

    python benchmarks/step.py [--steps 40] [--sizes 15 45 150] [--json FILE] [--page FILE]
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
from pathlib import Path
from typing import Any

from disk_under_way import MESHES, falling
from ngsolve_step import time_ngsolve
from stages import measured

from rigidfluid.core.run.process import one_openblas_thread


def compare(thousands: int, steps: int) -> dict[str, Any]:
    """One row: both on the same mesh, one after the other."""
    with one_openblas_thread():
        run = falling(thousands)
        ours = measured(run, steps)
        mesh = run.state.mesh
        assert mesh is not None
        unknowns = run.system.backend.unknowns(mesh, run.system.controlled)
        problem = run.system.backend.problem
        assert problem is not None
        theirs, their_unknowns = time_ngsolve(mesh, problem, run.clock.size(0), max(3, steps // 10))
    return {
        "unknowns": unknowns,
        "cells": len(mesh.cells),
        "seconds": ours["seconds"],
        "stages": ours["stages"],
        "ngsolve_unknowns": their_unknowns,
        "ngsolve_seconds": sum(theirs.values()),
        "ngsolve_stages": theirs,
        "ratio": ours["seconds"] / sum(theirs.values()),
    }


def show(row: dict[str, Any]) -> None:
    """Print one row and both profiles."""
    print(f"\n{row['unknowns']} unknowns, {row['cells']} cells (NGSolve: {row['ngsolve_unknowns']} unknowns)")
    print(f"  rigidfluid {row['seconds']:.4f} s a step, NGSolve {row['ngsolve_seconds']:.4f} s: {row['ratio']:.2f}")
    for title in ("stages", "ngsolve_stages"):
        for stage, seconds in sorted(row[title].items(), key=lambda item: -item[1]):
            print(f"    {title:15s} {stage:36s} {1000 * seconds:9.2f} ms")


PREAMBLE = """\
Made on {date} by `make bench` on {cores} cores. Seconds a step on the same mesh. NGSolve assembles and factorises
(UMFPACK) at every step; rigidfluid reuses factors, and its step includes moving the mesh, detection, the bodies and the
energy balance. Only the ratios of one run mean something.

What is left on the table: the iteration takes one back-substitution and some products with the matrix. Assembly uses
one core.
"""


def page(rows: list[dict[str, Any]]) -> str:
    """The rows as a Markdown page with its date and command."""
    lines = [
        "# One step beside NGSolve",
        "",
        PREAMBLE.format(date=datetime.date.today(), cores=os.cpu_count()),
        "| unknowns | rigidfluid [s] | NGSolve [s] | ratio |",
        "|---|---|---|---|",
        *(
            f"| {row['unknowns']} | {row['seconds']:.3f} | {row['ngsolve_seconds']:.3f} | {row['ratio']:.2f} |"
            for row in rows
        ),
        "",
        "| stage [ms] | " + " | ".join(str(row["unknowns"]) for row in rows) + " |",
        "|---" * (len(rows) + 1) + "|",
    ]
    for title, prefix in (("stages", ""), ("ngsolve_stages", "NGSolve: ")):
        for stage in rows[0][title]:
            figures = " | ".join(f"{1000 * row[title].get(stage, 0.0):.1f}" for row in rows)
            lines.append(f"| {prefix}{stage} | {figures} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the arguments, measure, print, and write the figures where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--sizes", type=int, nargs="+", default=[15, 45, 150], choices=list(MESHES))
    parser.add_argument("--json", type=Path)
    parser.add_argument("--page", type=Path, help="write a Markdown page here")
    arguments = parser.parse_args()
    rows = []
    for thousands in arguments.sizes:
        rows.append(compare(thousands, arguments.steps))
        show(rows[-1])
    if arguments.page:
        arguments.page.write_text(page(rows), encoding="utf-8")
    if arguments.json:
        arguments.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
