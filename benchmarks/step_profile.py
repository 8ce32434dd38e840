"""Stages of a step in each class of scenes, in CPU milliseconds of one thread, and how often it solves for the fluid.

python benchmarks/step_profile.py [CLASS ...] [--page docs/validation/step_profile.md]
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

from rigidfluid.python_process import ONE_THREAD

os.environ |= ONE_THREAD
ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests" / "support"))

import fluid_contacts  # noqa: E402
from contact_step import changed, hundred  # noqa: E402
from sphere_lattice import dry_spheres  # noqa: E402
from stages import STAGES, measured  # noqa: E402
from written_page import measurement, write_page  # noqa: E402

from rigidfluid.core.case.load import load_scene  # noqa: E402
from rigidfluid.core.run.process import one_openblas_thread  # noqa: E402
from rigidfluid.core.run.simulation import Simulation  # noqa: E402
from rigidfluid.core.scene.scene import Scene  # noqa: E402

STEP = 1e-3
COUNTS = ("solves", "iterations", "columns", "factorisations", "remeshes")


@dataclass(frozen=True)
class Case:
    """A class of scenes: one of them, which steps are ``reached`` before any is measured, and how many are then."""

    name: str
    scene: Callable[[], Scene]
    reached: Callable[[Simulation], bool]
    steps: int


def shipped(name: str) -> Scene:
    """A shipped scene, without outputs."""
    return changed(load_scene(ROOT / "scenes" / f"{name}.toml"))


def under_way(run: Simulation) -> bool:
    """Whether the graded steps of a start are over, and compiled code is loaded."""
    return run.state.count >= 6 and (run.state.level or 0) == 0


def touches(run: Simulation) -> bool:
    """Whether contacts are in range."""
    law = run.system.law
    return law is not None and bool(run.state.contacts.gap.min(initial=float("inf")) < law.range)


def rests(run: Simulation) -> bool:
    """Whether contacts last for a while."""
    return run.time >= 40 * STEP


CASES = (
    Case("free", lambda: shipped("falling_disk"), under_way, 60),
    Case("rest", lambda: fluid_contacts.resting(STEP), under_way, 14),
    Case("impact", lambda: fluid_contacts.dropped(STEP), touches, 20),
    Case("stack", lambda: fluid_contacts.column(STEP), rests, 40),
    Case("heap", lambda: fluid_contacts.heap(2 * STEP), rests, 40),
    Case("crowd, 2D", lambda: hundred(0.066, 2 * STEP), touches, 10),
    Case("crowd, 3D", lambda: shipped("many_bodies_3d"), touches, 10),
    Case("free, 3D", lambda: shipped("falling_sphere"), under_way, 10),
    Case("impact, 3D", lambda: fluid_contacts.ball_dropped(STEP), touches, 10),
    Case("joints", lambda: shipped("hinged_pair"), under_way, 40),
    Case("dry, two bodies", lambda: shipped("dry_bounce"), under_way, 100),
    Case("dry, 1,000 spheres", lambda: dry_spheres("centre", 10, 1), under_way, 80),
)


def row(case: Case) -> dict[str, Any]:
    """Means over the measured steps: CPU seconds and counts."""
    run = Simulation(case.scene(), None, False)
    while not case.reached(run):
        run.step()
    mesh = run.state.mesh
    unknowns = 0 if mesh is None else run.system.backend.unknowns(mesh, run.system.prescribed)
    with patch.object(time, "perf_counter", time.process_time):
        found = measured(run, case.steps)
    return {"class": case.name, "unknowns": unknowns} | found


def page(found: dict[str, Any]) -> str:
    """The rows as a Markdown page."""
    rows = found["rows"]

    def line(title: str, value: Callable[[dict[str, Any]], str]) -> str:
        return f"| {title} | " + " | ".join(value(row) for row in rows) + " |"

    table = [
        line("", lambda row: row["class"]),
        "|---" * (len(rows) + 1) + "|",
        line("unknowns", lambda row: f"{row['unknowns']:,}"),
        line("**whole step** [ms]", lambda row: f"{1e3 * row['seconds']:.1f}"),
        *(line(stage, lambda row, stage=stage: f"{1e3 * row['stages'][stage]:.1f}") for stage in STAGES),
        *(line(TITLES[count], lambda row, count=count: f"{row[count]:.3g}") for count in COUNTS),
    ]
    return PAGE.format(**found, table="\n".join(table))


TITLES = {
    "solves": "fluid solves a step",
    "iterations": "Krylov iterations a step",
    "columns": "columns of impulse responses a step",
    "factorisations": "factorisations in all",
    "remeshes": "re-meshes in all",
}

PAGE = """# Where the time of a step goes

Made on {date} by `python benchmarks/step_profile.py --page docs/validation/step_profile.md`. CPU milliseconds of one
thread, means over some ten to a hundred steps of a scene of each class; the load was {load:.1f} on {cores} cores.
"Impulse responses" are the linear solves for the reduced model of contacts, with their factorisations; "reduced model"
is what else it takes; "adapt mesh" is re-meshing, without the transfer of fields. Steps near impacts are shorter than
others, and cost less each.

{table}
"""


def main() -> None:
    """Measure the classes that are asked for, print each, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("classes", nargs="*", metavar="CLASS", help=", ".join(case.name for case in CASES))
    parser.add_argument("--page", type=Path, help="where to write the table as well")
    parser.add_argument("--kept", action="store_true", help="write the page of what is kept, and measure nothing")
    arguments, rows = parser.parse_args(), []
    with one_openblas_thread():
        for case in CASES:
            if not arguments.kept and (not arguments.classes or case.name in arguments.classes):
                rows.append(row(case))
                show(rows[-1])
    if arguments.page is not None:
        write_page(arguments.page, page(measurement(arguments.page, rows or None)), kept=arguments.kept)


def show(found: dict[str, Any]) -> None:
    """Print one class: stages from the longest down, then counts."""
    stages = sorted(found["stages"].items(), key=lambda stage: -stage[1])
    print(f"{found['class']}: {found['unknowns']:,} unknowns, {1e3 * found['seconds']:.1f} ms a step", flush=True)
    print("  " + ", ".join(f"{name} {1e3 * taken:.1f}" for name, taken in stages if taken > 0.01 * found["seconds"]))
    print("  " + ", ".join(f"{TITLES[count]} {found[count]:.3g}" for count in COUNTS), flush=True)


if __name__ == "__main__":
    main()
