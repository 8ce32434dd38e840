"""Under mpirun: steps of DOLFINx' backend on all processes against those of scikit-fem's on each alone.

    mpirun -n 3 python shared_steps.py SCENE MORE

SCENE is a file with a scene in JSON. Prints what both have come to, and how many bytes each process holds after more
steps, so many each time as MORE lists.
"""

import json
import sys
from pathlib import Path

from mpi4py import MPI

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.run.simulation import Simulation

STEPS, EVERY = 3, 2


def started(scene, **fluid):
    return Simulation(scene_from_dict({**scene, "fluid": scene["fluid"] | fluid}), None, False)


def go_on(simulation, steps):
    """With a new mesh every second one."""
    for _ in range(steps):
        simulation.mesh_updater.needs_remesh = lambda state, _: state.count % EVERY == 1
        simulation.step()


def figures(simulation):
    state, wrench = simulation.state, simulation.state.hydrodynamic_wrench
    return {
        "velocity": state.twist.velocity.tolist(),
        "angular_velocity": state.twist.angular_velocity.tolist(),
        "force": wrench.force.tolist(),
        "torque": wrench.torque.tolist(),
        "energy": list(simulation.history.records["energy"][-1][2:]),
        "probes": [list(row[3:]) for row in simulation.history.records["probes"]],
        "remeshes": simulation.counts.remeshes,
        "unknowns": simulation.system.backend.unknowns(state.mesh, simulation.system.prescribed),
    }


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


def main():
    scene = json.loads(Path(sys.argv[1]).read_text())
    shared, alone = started(scene, backend="dolfinx", solver="lu"), started(scene, backend="scikit-fem")
    for simulation in (shared, alone):
        go_on(simulation, STEPS)
    found, expected = figures(shared), figures(alone)
    held = []
    for steps in json.loads(sys.argv[2]):
        go_on(shared, steps)
        held.append(resident())
    everyones = MPI.COMM_WORLD.gather((found, held))
    if everyones is not None:
        print(json.dumps({"alone": expected, "shared": everyones}))


if __name__ == "__main__":
    main()
