"""Memory of a process that shares a settling sphere, or of one that makes its mesh and no more.

mpirun -n 2 python benchmarks/memory_model.py SIZE SIZE_BODY [--steps 3]    with DOLFINx and the Schur complement
python benchmarks/memory_model.py SIZE SIZE_BODY --steps 0                  the mesh alone, with its CPU seconds

Prints a row of the last process: unknowns, its share of them where they are shared, and the highest memory [byte].
"""

from __future__ import annotations

import argparse
import json
import time
from typing import Any

from settling_sphere import SCENE

from rigidfluid.core.case.load import load_scene
from rigidfluid.core.run.process import Launch, one_openblas_thread, peak_memory
from rigidfluid.core.run.simulation import Simulation


def measured(sizes: tuple[float, float], steps: int) -> dict[str, Any]:
    """The row of this process after so many steps."""
    backend = ["fluid.backend=dolfinx", "fluid.solver=schur"] if steps else ["fluid.backend=scikit-fem"]
    mesh = [f"mesh.size={sizes[0]}", f"mesh.size_body={sizes[1]}", "mesh.growth=0.2"]
    start = time.process_time()
    run = Simulation(load_scene(SCENE, [*backend, *mesh, "time.step=0.01"]), None, False)
    seconds = time.process_time() - start
    for _ in range(steps):
        run.step()
    unknowns = run.system.backend.unknowns(run.state.mesh, run.system.prescribed) / Launch.read().size
    return {"unknowns": int(unknowns), "bytes": peak_memory(), "seconds": round(seconds, 1)}


def main() -> None:
    """Read the arguments, measure and print the row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sizes", type=float, nargs=2)
    parser.add_argument("--steps", type=int, default=3)
    arguments = parser.parse_args()
    with one_openblas_thread():
        row = measured(tuple(arguments.sizes), arguments.steps)
    launch = Launch.read()
    if launch.rank == launch.size - 1:
        print(json.dumps(row))


if __name__ == "__main__":
    main()
