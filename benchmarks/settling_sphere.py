"""A sphere starts to settle in 3D: iterations, seconds and memory of the Schur solver over cell size and step.

python benchmarks/settling_sphere.py [--backend dolfinx] [--mesh 0 --mesh 1] [--length 0.01] [--steps 20] [--page FILE]

With `dolfinx` also under mpirun. Memory is the highest until then: for that of one mesh measure it alone.
"""

from __future__ import annotations

import argparse
import datetime
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from written_page import write_page

from rigidfluid.core.run.process import one_openblas_thread, peak_memory
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.setup.load import load_scene
from rigidfluid.taylor_hood.lagged_solver import LaggedSolver

SCENE = Path(__file__).parents[1] / "scenes" / "falling_sphere.toml"
# (size, size_body, growth) of the mesh: 55,000, 160,000 and more than 300,000 unknowns.
MESHES = ((1.2, 0.3, 0.2), (0.8, 0.16, 0.2), (0.58, 0.11, 0.2))
STEPS = (0.1, 0.01, 0.001)
"""Lengths of the step [s]."""
FINEST = (MESHES[-1], 0.01)
"""The case that takes all steps; the others take a third of them."""


@dataclass(frozen=True)
class Row:
    """One case: iterations of each solution, and what a step took: wall seconds, and CPU seconds of all processes; the
    ``memory`` of all processes at its highest until then [byte]."""

    unknowns: int
    step: float
    iterations: list[int]
    seconds: float
    cpu_seconds: float
    memory: int
    speed: float


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


def settle(backend_name: str, mesh: tuple[float, float, float], step: float, steps: int) -> tuple[Row, bool]:
    """The first steps of one case; also whether this process may print."""
    sizes = zip(("size", "size_body", "growth"), mesh, strict=True)
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
    unknowns = backend.unknowns(run.state.mesh, run.system.controlled)
    speed = float(-run.state.twist.velocity[0, 1])
    cpu_of_all, memory = float(ranks.sum(cpu_seconds)), int(ranks.sum(peak_memory() or 0))
    return Row(unknowns, step, iterations, seconds, cpu_of_all, memory, speed), ranks.is_root


PREAMBLE = """\
# A sphere starts to settle

Made on {date} by `{command}` on {cores} cores, {ranks}. The scene is `scenes/falling_sphere.toml`, at rest at first;
backend `{backend}`, `solver = "schur"`, relative residual 10⁻⁹. Iterations are FGMRES' for fluid and body together,
with one velocity block and one Cahouet–Chabard block each. CPU seconds and memory are of all processes, memory at its
highest until then.

| unknowns | step [s] | solutions | iterations: least, mean, most | seconds a step | CPU seconds a step |\
 memory [GiB] | speed reached [cm/s] |
|---|---|---|---|---|---|---|---|
"""


def line(row: Row) -> str:
    """Of the table."""
    counts = row.iterations
    least, mean, most = min(counts), sum(counts) / len(counts), max(counts)
    return (
        f"| {row.unknowns} | {row.step:g} | {len(counts)} | {least}, {mean:.1f}, {most} | {row.seconds:.2f} |"
        f" {row.cpu_seconds:.2f} | {row.memory / 2**30:.2f} | {row.speed:.4g} |"
    )


def main() -> None:
    """Read the arguments, measure, print, and write the page where asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--backend", default="dolfinx")
    parser.add_argument("--mesh", type=int, action="append", choices=range(len(MESHES)), help="0 is the coarsest")
    parser.add_argument("--length", type=float, action="append", help="of the step [s]")
    parser.add_argument("--steps", type=int, default=20, help="of the finest case; others take a third")
    parser.add_argument("--page", type=Path, help="write a Markdown page here")
    arguments = parser.parse_args()
    rows, speaks = [], True
    with one_openblas_thread():
        for mesh in [MESHES[number] for number in arguments.mesh or range(len(MESHES))]:
            for step in arguments.length or STEPS:
                steps = arguments.steps if (mesh, step) == FINEST else max(2, arguments.steps // 3)
                row, speaks = settle(arguments.backend, mesh, step, steps)
                rows.append(row)
                if speaks:
                    print(line(row), flush=True)
    means = [sum(row.iterations) / len(row.iterations) for row in rows]
    mosts = [max(row.iterations) for row in rows]
    size = int(os.environ.get("OMPI_COMM_WORLD_SIZE", "1"))
    text = PREAMBLE.format(
        date=datetime.date.today(),
        command=" ".join(["python benchmarks/settling_sphere.py", *sys.argv[1:]]),
        cores=os.cpu_count(),
        backend=arguments.backend,
        ranks="one process" if size == 1 else f"{size} processes of mpirun",
    )
    text += "\n".join(map(line, rows))
    text += f"\n\nMean iterations differ by a factor of {max(means) / min(means):.2f} between all cases,"
    text += f" the most of each by {max(mosts) / min(mosts):.2f}.\n"
    if speaks and arguments.page:
        write_page(arguments.page, text)


if __name__ == "__main__":
    main()
