"""Dry runs of bodies with joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigidfluid.core.mechanics.kinematics import component_twist
from rigidfluid.core.mechanics.linkage import JointLinkage
from rigidfluid.core.mechanics.rigid import lab_inertia, moment
from rigidfluid.core.model.linkage import GroundLink, Joint
from rigidfluid.core.model.types import FloatArray
from rigidfluid.core.run.initial_state import initial_state
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene


def linked_run(scene: Scene, joints: Sequence[Joint] = (), ground: Sequence[GroundLink] = ()) -> Simulation:
    """At its start, with twists that the joints allow."""
    it = Simulation(scene)
    system = it.system
    given = system.mass, system.inertia, system.controlled, system.controlled_twist, system.mechanisms
    linkage = JointLinkage(system.pose, joints, ground, *given)
    carried = system.mechanisms
    if carried is None:
        system = replace(system, twist=linkage.fitting(system.pose, system.twist, 0.0))
    else:
        carried.twist = linkage.fitting(carried.pose, carried.twist, 0.0)
        system = replace(system, twist=component_twist(carried.at(carried.pose, 0.0), carried.twist))
    it.stepper.system = replace(system, linkage=linkage)
    it.state = initial_state(it.system, it.mesh_updater, it.clock)
    it.history.cut(dict.fromkeys(it.history.lengths, 0))
    it._record()
    return it


def momenta(it: Simulation) -> FloatArray:
    """Of all bodies, momentum and angular momentum about the origin (d+k,)."""
    system, pose, twist = it.system, it.state.pose, it.state.twist
    linear = system.mass[:, None] * twist.velocity
    spin = np.einsum("nij,nj->ni", lab_inertia(system.inertia, pose.orientation), twist.angular_velocity)
    return np.concatenate([linear.sum(axis=0), (spin + moment(pose.position, linear)).sum(axis=0)])


def gap(it: Simulation) -> float:
    """The greatest misfit of its joints."""
    assert it.system.linkage is not None
    return float(np.abs(it.system.linkage.misfit(it.state.free_pose, it.time)).max())
