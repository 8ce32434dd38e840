"""The scene as rigidfluid runs it, with a fixed step."""

from __future__ import annotations

import numpy as np

from rigidfluid.api import FloatArray, Motion, Scene, Simulation, scene_from_dict
from rigidfluid_lammps.samples import Sample, Samples
from rigidfluid_lammps.timing import Timing


def run_ours(scene: Scene, timing: Timing) -> Samples:
    """Run a dry scene, a block being a step of the run and a step one substep; samples at its start and block ends.

    Raises StepError if bodies overlap.
    """
    simulation = Simulation(_timed(scene, timing), None, False)
    samples = [_sample(simulation)]
    simulation.observe(lambda now: samples.append(_sample(now)))
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


def _sample(now: Simulation) -> Sample:
    state = now.state
    velocity, spin = state.twist.velocity, state.twist.angular_velocity
    stored = state.ledger.contact
    if state.springs is not None:
        stored -= float(state.springs.energy.sum())  # LAMMPS does not tell what springs along the surfaces hold
    return Sample(state.pose.position, velocity, spin, stored, _wall_forces(now))


def _wall_forces(now: Simulation) -> FloatArray:
    """Force with which the bodies push each wall outwards (w,) [force]; a ball's rotation has no share in it."""
    system, contacts = now.system, now.state.contacts
    if system.law is None or len(contacts) == 0:
        return np.zeros(len(system.walls))
    pushed = system.law.force(contacts)
    if system.law.dissipative:
        body = contacts.body_a
        # Walls are at rest; rows of pairs are not summed below.
        motion = Motion(now.state.twist.velocity[body], system.mass[body])
        pushed = pushed + system.law.damping(contacts, motion)
    normal_force = np.sum(pushed * contacts.normal, axis=1)
    return np.array([normal_force[contacts.body_b == wall.surface].sum() for wall in system.walls])
