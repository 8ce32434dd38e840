"""The scene as rigidfluid runs it, with a fixed step."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.rigid import cross
from rigidfluid.core.model.contacts import middle, select
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray, Motion
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.load import scene_from_dict
from rigidfluid.evaluation.crosscheck.samples import Sample, Samples
from rigidfluid.evaluation.crosscheck.timing import Timing


def run_ours(scene: Scene, timing: Timing) -> Samples:
    """Run a dry scene, a block being a step of the run and a step one substep; samples at its start and block ends.

    Raises StepError if bodies overlap.
    """
    simulation = Simulation(_timed(scene, timing), None, False)
    samples = [_sample(simulation.system, simulation.state)]
    simulation.observe(lambda now: samples.append(_sample(now.system, now.state)))
    simulation.go()
    return Samples.stack(timing.times, samples)


def _timed(scene: Scene, timing: Timing) -> Scene:
    data = scene.to_dict()
    block = timing.steps * timing.step
    # The shortest step is the block: a step that is cut would not be LAMMPS' step.
    data["time"] = {"step": block, "shortest": block, "end": timing.blocks * block}
    data["output"] = {"every": timing.blocks * block}
    data["contact"] |= {"stepping": "substeps", "substeps": timing.steps}
    return scene_from_dict(data)


def _sample(system: System, state: State) -> Sample:
    return Sample(
        state.pose.position,
        state.twist.velocity,
        state.twist.angular_velocity,
        state.ledger.contact,
        _wall_forces(system, state),
    )


def _wall_forces(system: System, state: State) -> FloatArray:
    """How hard the bodies push each wall outwards (w,) [force]."""
    forces = np.zeros(len(system.walls))
    near = select(state.contacts, state.contacts.at_wall)
    if system.law is None or len(near) == 0:
        return forces
    body = near.body_a
    pushed = system.law.force(near)
    if system.law.dissipative:
        arm = middle(near) - state.pose.position[body]
        velocity = state.twist.velocity[body] + cross(state.twist.angular_velocity[body], arm)
        pushed = pushed + system.law.damping(near, Motion(velocity, system.mass[body]))
    normal_force = np.sum(pushed * near.normal, axis=1)
    for number, wall in enumerate(system.walls):
        forces[number] = normal_force[near.body_b == wall.surface].sum()
    return forces
