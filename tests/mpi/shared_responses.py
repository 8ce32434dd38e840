"""Under mpirun: impulse responses by DOLFINx' backend on all processes against those of scikit-fem's on each alone.

    mpirun -n 2 python shared_responses.py SCENE MORE

SCENE is a file with a scene in JSON. Prints the responses of both after some steps with a new mesh among them, how
fluid and bodies respond to impulses in a step, and how many bytes each process holds after they were evaluated again,
as often each time as MORE lists.
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from mpi4py import MPI
from shared_steps import go_on, resident, started

from rigidfluid.core.mechanics.fluid_step import StepEnd, step_to
from rigidfluid.core.mechanics.wrenches import nothing

STEPS = 3


def responses(simulation):
    """On the present mesh, to each component of an impulse by itself, and of a step to all of them."""
    system, state = simulation.system, simulation.state
    end = StepEnd(1.0, simulation.model.time.step, state.pose, nothing(state.pose))
    step = step_to(system, state, end, state.mesh.geometry)
    units = np.eye(step.load.size).reshape(-1, *step.load.shape)
    response = system.backend.response(state.fluid, state.mesh, step, units)
    impulse = 0.01 * (1.0 + np.arange(step.load.size)).reshape(step.load.shape)
    pushed = replace(step, load=step.load + step.derivative[0] * impulse, impulse=impulse)
    advance = system.backend.advance(state.fluid, state.mesh, pushed)
    turned = system.backend.advance(state.fluid, state.mesh, replace(pushed, turning=impulse))
    return {
        "inviscid": response.inviscid.tolist(),
        "viscous": response.viscous.tolist(),
        "twist": advance.twist.velocity.tolist(),
        "turned": turned.twist.velocity.tolist(),
    }


def main():
    scene = json.loads(Path(sys.argv[1]).read_text())
    shared, alone = (started(scene, backend=name) for name in ("dolfinx", "scikit-fem"))
    for simulation in (shared, alone):
        go_on(simulation, STEPS)
    found, expected = responses(shared), responses(alone)
    held = []
    for times in json.loads(sys.argv[2]):
        for _ in range(times):
            responses(shared)
        held.append(resident())
    everyones = MPI.COMM_WORLD.gather((found, held))
    if everyones is not None:
        print(json.dumps({"alone": expected, "shared": everyones}))


if __name__ == "__main__":
    main()
