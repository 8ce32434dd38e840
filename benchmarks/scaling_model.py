"""A model, not a measurement, of a 3D step on many processes: constants of a run on two, and a network that is assumed.

mpirun -n 2 python benchmarks/scaling_model.py [--mesh 0|1|2] [--steps 5] [--latency 2e-6] [--bandwidth 1e10]

T(N, p) = c N/p + r α log₂ p + m α + v (N/p)^⅔ / β

Measured in a run of N unknowns on two processes that have a core each: c, the CPU time a step and unknown, with what
the processes wait for each other; r, the global sums of a step; m, its rounds of messages between neighbours; v, their
bytes over (N/p)^⅔. Assumed: the network's latency α [s] and bandwidth β [bytes/s]. Left out: what is not shared out
(meshes are made by one process), coarse levels of multigrid that have less than one unknown a process, unequal parts.
"""

from __future__ import annotations

import argparse
import time

from mpi4py import MPI
from petsc4py import PETSc
from settling_sphere import MESHES, SCENE
from step_model import Constants, model_lines

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.run.process import one_openblas_thread
from rigidfluid.core.run.simulation import Simulation

SUMS = ("VecDot", "VecTDot", "VecMDot", "VecNorm")
EXCHANGES = ("VecScatterBegin", "SFBcastBegin", "SFReduceBegin")


def logged(names: tuple[str, ...], entry: str) -> float:
    """The sum over PETSc's events of this process."""
    return float(sum(PETSc.Log.Event(name).getPerfInfo()[entry] for name in names))


def measured(mesh: int, steps: int) -> tuple[int, Constants]:
    """The unknowns and constants of a settling sphere on the processes that share the run."""
    sizes = zip(("size", "size_body", "growth"), MESHES[mesh], strict=True)
    settings = ["fluid.backend=dolfinx", "time.step=0.01", *(f"mesh.{key}={value}" for key, value in sizes)]
    run = Simulation(load_scene(SCENE, settings), None, False)
    run.step()  # factors and compiled forms are there
    PETSc.Log.begin()
    before = logged(SUMS, "count"), logged(EXCHANGES, "count"), logged(EXCHANGES, "messageLength")
    start = time.process_time()
    for _ in range(steps):
        run.step()
    seconds = run.system.backend.ranks.sum(time.process_time() - start)
    sums, rounds, sent = (
        now - then
        for now, then in zip(
            (logged(SUMS, "count"), logged(EXCHANGES, "count"), logged(EXCHANGES, "messageLength")), before, strict=True
        )
    )
    unknowns = run.system.backend.unknowns(run.state.mesh, run.system.prescribed)
    local = unknowns / MPI.COMM_WORLD.size
    constants = Constants(seconds / steps / unknowns, sums / steps, rounds / steps, sent / steps / local ** (2 / 3))
    return unknowns, constants


def main() -> None:
    """Read the arguments, measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", type=int, default=0, choices=range(len(MESHES)))
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--latency", type=float, default=2e-6)
    parser.add_argument("--bandwidth", type=float, default=1e10)
    arguments = parser.parse_args()
    with one_openblas_thread():
        unknowns, found = measured(arguments.mesh, arguments.steps)
    if MPI.COMM_WORLD.rank:
        return
    print(f"{unknowns} unknowns on {MPI.COMM_WORLD.size} processes, a step:")
    print(f"  {1e6 * found.seconds:.2f} µs CPU an unknown, {found.sums:.0f} global sums, {found.rounds:.0f} exchanges,")
    print(f"  {found.bytes:.0f} bytes over (N/p)^(2/3)")
    print(*model_lines(found, arguments.latency, arguments.bandwidth), sep="\n")


if __name__ == "__main__":
    main()
