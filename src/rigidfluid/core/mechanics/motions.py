"""Motions that carry a system's bodies: their loads, accelerations, inverse masses and extents."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.kinematics import carried_sum, component_twist, free_wrench, levers
from rigidfluid.core.mechanics.rigid import cross, inverse_lab_inertia, lab_inertia, rotation_matrices
from rigidfluid.core.mechanics.wrenches import flat, nothing, wrench_of, wrench_sum
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Kinematics, Pose, Twist, Wrench


def weights(system: System, kinematics: Kinematics | None) -> Wrench:
    """Weight of all that each motion carries, and its torque about the centre of mass, N rows."""
    return free_wrench(kinematics, Wrench(system.weight, np.zeros_like(system.inertia[:, 0])))


def applied_wrench(system: System, state: State, kinematics: Kinematics | None) -> Wrench:
    """Mean applied wrench on the motions in the step from ``state`` to ``kinematics`` at its end, N rows."""
    if state.applied is None:
        return nothing(state.free_pose)
    if kinematics is None:
        return state.applied
    start, end = (flat(free_wrench(at, state.applied)) for at in (kinematics_now(system, state), kinematics))
    return wrench_of(0.5 * (start + end), system.dimension)


def outer_load(system: System, state: State) -> Wrench:
    """Weight and applied wrenches on all that each motion carries, N rows."""
    kinematics = kinematics_now(system, state)
    return wrench_sum(weights(system, kinematics), applied_wrench(system, state, kinematics))


def newly_applied(system: System, state: State) -> Wrench:
    """Applied wrench on the motions from now on, less its mean in the latest step, N rows."""
    now = applied_wrench(system, state, kinematics_now(system, state))
    if state.past is None or state.past.applied is None:
        return now
    return Wrench(now.force - state.past.applied.force, now.torque - state.past.applied.torque)


def carried_bodies(system: System, motions: Pose, twist: Twist, time: float) -> tuple[Pose, Twist]:
    """Poses and twists of the bodies, evaluated from those of the motions at a ``time``."""
    if system.mechanisms is None:
        return motions, twist
    return system.mechanisms.poses(motions, time), component_twist(system.mechanisms.kinematics(motions, time), twist)


def kinematics_now(system: System, state: State) -> Kinematics | None:
    """Kinematics G and g of a state, read from its poses and twists."""
    if system.mechanisms is None:
        return None
    carrier, centre = system.mechanisms.carrier, state.free_pose.position
    arm = state.pose.position - centre[carrier]
    rigid = Kinematics(carrier, centre, arm, np.zeros_like(flat(state.twist)))
    given = flat(state.twist) - flat(component_twist(rigid, state.free_twist))
    return Kinematics(carrier, centre, arm, given)


def accelerations(system: System, state: State) -> FloatArray:
    """Accelerations of the motions (N, d+k) in the latest step, less the share of contacts, plus that of wrenches
    applied since; at the start those by weight and applied wrenches [length/time² | rad/time²]."""
    linear, angular = mobility(system, state)
    if state.past is None:
        return _answer(linear, angular, outer_load(system, state))
    rate = (flat(state.free_twist) - flat(state.past.twist)) / state.past.step
    rate -= _answer(linear, angular, state.free_contact)
    if state.applied is None:
        return rate
    return rate + _answer(linear, angular, newly_applied(system, state))


def body_accelerations(system: System, state: State, time: float, size: float) -> FloatArray:
    """Accelerations of the bodies (n, d+k), A + α × arm + ω × (ω × arm) of the motions that carry them, and the mean
    rate of the relative velocity from ``time`` on over ``size`` [length/time² | rad/time²]."""
    rate, mechanisms = accelerations(system, state), system.mechanisms
    if mechanisms is None:
        return rate
    now, later = (mechanisms.kinematics(state.free_pose, when) for when in (time, time + size))
    d, carrier, arm = system.dimension, now.carrier, now.arm
    spin = state.free_twist.angular_velocity[carrier]
    turning = cross(rate[carrier, d:], arm) + cross(spin, cross(spin, arm))
    carried = np.concatenate([rate[carrier, :d] + turning, rate[carrier, d:]], axis=1)
    return np.asarray(carried + (later.given - now.given) / size)


def _answer(linear: FloatArray, angular: FloatArray, wrench: Wrench) -> FloatArray:
    """Acceleration M⁻¹ W of the motions by a wrench W on them (N, d+k)."""
    by_force = np.einsum("nij,nj->ni", linear, wrench.force)
    return np.concatenate([by_force, np.einsum("nij,nj->ni", angular, wrench.torque)], axis=1)


def mobility(system: System, state: State) -> tuple[FloatArray, FloatArray]:
    """Inverse mass (N, d, d), with the added mass of bodies, and inverse inertia (N, k, k) of each motion alone in the
    lab frame, zero for prescribed motions [1/mass | 1/(mass·length²)]."""
    orientation, eye = state.pose.orientation, np.eye(system.dimension)
    rotation = rotation_matrices(orientation)
    own = system.mass[:, None, None] * eye
    mass = own + rotation @ system.added_mass @ np.swapaxes(rotation, -1, -2)
    free, kinematics = ~system.controlled_motions[:, None, None], kinematics_now(system, state)
    if kinematics is None:
        return free * np.linalg.inv(mass), free * inverse_lab_inertia(system.inertia, orientation)
    lever = levers(kinematics.arm)
    turning = lab_inertia(system.inertia, orientation) + np.swapaxes(lever, -1, -2) @ mass @ lever
    whole = (carried_sum(kinematics.carrier, each, len(kinematics.centre)) for each in (mass, turning))
    linear, angular = (free * np.linalg.inv(each) for each in whole)
    return linear, angular


def reaches(system: System) -> tuple[FloatArray, FloatArray]:
    """Largest bounding radius of the bodies of each motion, and the distance of its farthest point from its centre of
    mass, (N,) each [length]."""
    radii = np.array([body.bounding_radius for body in system.bodies])
    if system.mechanisms is None:
        return radii, radii
    carrier, centre = system.mechanisms.carrier, system.mechanisms.pose.position
    arm = np.linalg.norm(system.pose.position - centre[carrier], axis=1)
    largest, farthest = np.zeros((2, len(centre)))
    np.maximum.at(largest, carrier, radii)
    np.maximum.at(farthest, carrier, arm + radii)
    return largest, farthest


def twist_arms(system: System) -> FloatArray:
    """Factors (N, d+k) that turn components of twists into velocities: 1, and for angular ones the distance of the
    motion's farthest point [1 | length]."""
    farthest, d = reaches(system)[1], system.dimension
    return np.repeat([np.ones_like(farthest), farthest], [d, 1 if d == 2 else 3], axis=0).T


def round_motions(system: System) -> BoolArray:
    """Whether a motion is that of a single ball, which turns in its place (N,)."""
    balls = np.array([body.radius is not None for body in system.bodies])
    if system.mechanisms is None:
        return balls
    count = np.bincount(system.mechanisms.carrier)
    return np.asarray((carried_sum(system.mechanisms.carrier, balls, len(count)) == 1) & (count == 1))


def carriers(system: System) -> IntArray:
    """Number of the motion of each body (n,)."""
    return np.arange(len(system.bodies)) if system.mechanisms is None else system.mechanisms.carrier
