"""A sphere starts to settle in 3D: iterations, seconds and memory of the Schur solver over cell size and step.

python benchmarks/settling_sphere.py [--backend dolfinx] [--mesh 0 --mesh 1] [--length 0.01] [--steps 20] [--page FILE]

With `dolfinx` also under mpirun. Memory is the highest until then: for that of one mesh measure it alone. What is
measured for a page goes to settling_sphere.json, in the place of the same case before; the page shows all of it.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path

import numpy as np
from written_page import write_page

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.run.process import one_openblas_thread, peak_memory
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver

STORE = Path(__file__).with_suffix(".json")
SCENE = Path(__file__).resolve().parents[1] / "scenes" / "falling_sphere.toml"
# (size, size_body, growth) of the mesh: 55,000, 160,000 and more than 300,000 unknowns.
MESHES = ((1.2, 0.3, 0.2), (0.8, 0.16, 0.2), (0.58, 0.11, 0.2))
STEPS = (0.1, 0.01, 0.001)
"""Lengths of the step [s]."""
FINEST = (len(MESHES) - 1, 0.01)
"""The case that takes all steps; the others take a third of them."""


@dataclass(frozen=True)
class Row:
    """One case: iterations of each solution, and what a step took: wall seconds, and CPU seconds of all processes; the
    ``memory`` of all processes at its highest until then [byte]; the speed reached [cm/s]."""

    backend: str
    processes: int
    mesh: int
    step: float
    date: str
    unknowns: int
    iterations: list[int]
    seconds: float
    cpu_seconds: float
    memory: int
    speed: float

    @property
    def case(self) -> tuple[str, int, int, float]:
        """What two rows of one page must differ in; in the order of the page."""
        return self.backend, self.processes, self.mesh, -self.step


@contextmanager
def counted(iterations: list[int]) -> Iterator[None]:
    """Collects the iterations of every solution."""
    solve = LaggedSolver.solve

    def counting(self, *arguments, **more):  # type: ignore[no-untyped-def]
        found = solve(self, *arguments, **more)
        iterations.append(found[1])
        return found

    LaggedSolver.solve = counting  # type: ignore[method-assign]
    try:
        yield
    finally:
        LaggedSolver.solve = solve  # type: ignore[method-assign]


def settle(backend_name: str, mesh: int, step: float, steps: int) -> tuple[Row, bool]:
    """The first steps of one case; also whether this process may print and write."""
    sizes = zip(("size", "size_body", "growth"), MESHES[mesh], strict=True)
    fluid = [f"fluid.backend={backend_name}", "fluid.solver=schur"]
    settings = [*fluid, f"time.step={step}", *(f"mesh.{key}={value}" for key, value in sizes)]
    run = Simulation(load_scene(SCENE, settings), None, False)
    iterations: list[int] = []
    start, cpu_start = time.perf_counter(), time.process_time()
    with counted(iterations):
        for _ in range(steps):
            run.step()
    seconds, cpu_seconds = (time.perf_counter() - start) / steps, (time.process_time() - cpu_start) / steps
    backend, ranks = run.system.backend, run.system.backend.ranks
    row = Row(
        backend=backend_name,
        processes=ranks.size,
        mesh=mesh,
        step=step,
        date=str(datetime.date.today()),
        unknowns=backend.unknowns(run.state.mesh, run.system.prescribed),
        iterations=iterations,
        seconds=seconds,
        cpu_seconds=float(ranks.sum(cpu_seconds)),
        memory=int(ranks.sum(peak_memory() or 0)),
        speed=float(-run.state.twist.velocity[0, 1]),
    )
    return row, ranks.is_root


PREAMBLE = """\
# A sphere starts to settle in 3D

Steps of a sphere in a box, `scenes/falling_sphere.toml` with other cells, at rest at first; `solver = "schur"`, its
relative residual 10⁻⁹. Iterations are GMRES' for fluid and body together, of each solution that was asked for. Seconds
are of a step on the mean, the first preconditioner in it; CPU seconds and memory are of all processes, memory at its
highest until then in the same program. Several processes wait for each other busily, which counts as CPU time. Made by
`python benchmarks/settling_sphere.py --page docs/validation/settling_sphere.md`, under `mpirun` where there are several
processes, on {cores} cores that do other work too: only CPU seconds can be compared.
"""
TABLE = """
## `{backend}`, {processes}

| unknowns | step [s] | solutions | iterations: least, mean, most | seconds a step | CPU seconds a step |\
 memory [GiB] | speed reached [cm/s] | date |
|---|---|---|---|---|---|---|---|---|
"""


def line(row: Row) -> str:
    """Of the table."""
    counts = row.iterations
    least, mean, most = min(counts), sum(counts) / len(counts), max(counts)
    return (
        f"| {row.unknowns} | {row.step:g} | {len(counts)} | {least}, {mean:.1f}, {most} | {row.seconds:.2f} |"
        f" {row.cpu_seconds:.2f} | {row.memory / 2**30:.2f} | {row.speed:.4g} | {row.date} |"
    )


def remarks(rows: Sequence[Row]) -> Iterator[str]:
    """How iterations differ between the cases of one table, and how a step's cost grows."""
    if len(rows) < 2:
        return
    mosts = [max(row.iterations) for row in rows]
    ratio = max(mosts) / min(mosts)
    yield f"The largest numbers of iterations lie between {min(mosts)} and {max(mosts)}, a ratio of {ratio:.2f}."
    alike = [row for row in rows if row.step == FINEST[1]]
    if len(alike) > 1:
        first, last = alike[0], alike[-1]
        for kind in ("CPU seconds", "seconds"):
            name = kind.lower().replace(" ", "_")
            growth = np.log(getattr(last, name) / getattr(first, name)) / np.log(last.unknowns / first.unknowns)
            yield f"With a step of {last.step:g} its {kind} grow as the unknowns to the power of {growth:.2f}."


def page(rows: Sequence[Row]) -> str:
    """All that was measured."""
    text = PREAMBLE.format(cores=os.cpu_count())
    for (backend, size), table in groupby(rows, lambda row: row.case[:2]):
        of_table = list(table)
        processes = "one process" if size == 1 else f"{size} processes"
        text += TABLE.format(backend=backend, processes=processes) + "\n".join(map(line, of_table)) + "\n"
        found = list(remarks(of_table))
        text += "\n" + "\n".join(found) + "\n" if found else ""
    return text


def stored(new: Sequence[Row]) -> list[Row]:
    """The rows measured before, with ``new`` ones in their places, as they are stored now."""
    before = [Row(**row) for row in json.loads(STORE.read_text(encoding="utf-8"))] if STORE.exists() else []
    rows = list(({row.case: row for row in before} | {row.case: row for row in new}).values())
    rows.sort(key=lambda row: row.case)
    lines = ",\n".join(json.dumps(asdict(row)) for row in rows)
    STORE.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    return rows


def main() -> None:
    """Read the arguments, measure, print, and write the page where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--backend", default="dolfinx")
    parser.add_argument("--mesh", type=int, action="append", choices=range(len(MESHES)), help="0 is the coarsest")
    parser.add_argument("--length", type=float, action="append", help="of the step [s]")
    parser.add_argument("--steps", type=int, default=20, help="of the finest case; others take a third")
    parser.add_argument("--page", type=Path, help="write a Markdown page here")
    arguments = parser.parse_args()
    with one_openblas_thread():
        for mesh in arguments.mesh or range(len(MESHES)):
            for step in arguments.length or STEPS:
                steps = arguments.steps if (mesh, step) == FINEST else max(2, arguments.steps // 3)
                row, speaks = settle(arguments.backend, mesh, step, steps)
                if speaks:
                    print(line(row), flush=True)
                if speaks and arguments.page:
                    write_page(arguments.page, page(stored([row])))


if __name__ == "__main__":
    main()
