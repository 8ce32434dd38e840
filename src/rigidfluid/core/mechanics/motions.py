"""The motions that carry a system's bodies: what they weigh, how easily they give way, where they take the bodies."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.kinematics import carried_sum, component_twist, free_wrench, levers
from rigidfluid.core.mechanics.rigid import cross, inverse_lab_inertia, lab_inertia, rotation_matrices
from rigidfluid.core.mechanics.wrenches import flat, nothing, together, wrench_of
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Kinematics, Pose, Twist, Wrench


def weights(system: System, kinematics: Kinematics | None) -> Wrench:
    """Of all that each motion carries: the sum, and its torque about the centre of mass, N rows."""
    return free_wrench(kinematics, Wrench(system.weight, np.zeros_like(system.inertia[:, 0])))


def applied_wrench(system: System, state: State, kinematics: Kinematics | None) -> Wrench:
    """Mean wrench from outside on the motions in the step from ``state`` to where they carry the bodies by
    ``kinematics``, N rows."""
    if state.applied is None:
        return nothing(state.free_pose)
    if kinematics is None:
        return state.applied
    start, end = (flat(free_wrench(at, state.applied)) for at in (kinematics_now(system, state), kinematics))
    return wrench_of(0.5 * (start + end), system.dimension)


def outer_load(system: System, state: State) -> Wrench:
    """Weight and wrenches from outside, of all that each motion carries, N rows."""
    kinematics = kinematics_now(system, state)
    return together(weights(system, kinematics), applied_wrench(system, state, kinematics))


def newly_applied(system: System, state: State) -> Wrench:
    """Wrench from outside on the motions from now on, less its mean in the latest step, N rows."""
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
    """G and g of a state, read from its poses and twists."""
    if system.mechanisms is None:
        return None
    carrier, centre = system.mechanisms.carrier, state.free_pose.position
    arm = state.pose.position - centre[carrier]
    rigid = Kinematics(carrier, centre, arm, np.zeros_like(flat(state.twist)))
    given = flat(state.twist) - flat(component_twist(rigid, state.free_twist))
    return Kinematics(carrier, centre, arm, given)


def accelerations(system: System, state: State) -> FloatArray:
    """Of the motions in the latest step, without what their contacts gave, and with what has been applied since; at the
    start what weight and applied wrenches give.

    Parameters
    ----------
    system : System
        Bodies and mechanisms.
    state : State
        Now.

    Returns
    -------
    (N, d+k) array
        [length/time² | rad/time²].
    """
    linear, angular = mobility(system, state)
    if state.past is None:
        return _answer(linear, angular, outer_load(system, state))
    rate = (flat(state.free_twist) - flat(state.past.twist)) / state.past.step
    rate -= _answer(linear, angular, state.free_contact)
    if state.applied is None:
        return rate
    return rate + _answer(linear, angular, newly_applied(system, state))


def body_accelerations(system: System, state: State, time: float, size: float) -> FloatArray:
    """Of the bodies, as the motions carry them, A + α × arm + ω × (ω × arm), and what relative motion adds to that.

    Parameters
    ----------
    system : System
        Bodies and mechanisms.
    state : State
        Now.
    time, size : float
        When that is, and for how long relative motion is looked at from then on [time].

    Returns
    -------
    (n, d+k) array
        As in `accelerations`.
    """
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
    """M⁻¹ times a wrench on the motions (N, d+k)."""
    by_force = np.einsum("nij,nj->ni", linear, wrench.force)
    return np.concatenate([by_force, np.einsum("nij,nj->ni", angular, wrench.torque)], axis=1)


def mobility(system: System, state: State) -> tuple[FloatArray, FloatArray]:
    """How easily motions give way in straight motion and in rotation, each by itself, zero for those that are given.

    Parameters
    ----------
    system : System
        Bodies and mechanisms.
    state : State
        Where they are.

    Returns
    -------
    (N, d, d) array, (N, k, k) array
        Inverse mass, the added mass of bodies with it, and inverse inertia, in the lab frame
        [1/mass | 1/(mass·length²)].
    """
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
    """How large what each motion carries is at most, and how far from its centre of mass it reaches (N,) [length]."""
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
    """What makes velocities of all components of twists (N, d+k): 1, and of angular ones how far a motion reaches
    [1 | length]."""
    farthest, d = reaches(system)[1], system.dimension
    return np.repeat([np.ones_like(farthest), farthest], [d, 1 if d == 2 else 3], axis=0).T


def round_motions(system: System) -> BoolArray:
    """Which motions are those of single balls, which turn in their place (N,)."""
    balls = np.array([body.radius is not None for body in system.bodies])
    if system.mechanisms is None:
        return balls
    count = np.bincount(system.mechanisms.carrier)
    return np.asarray((carried_sum(system.mechanisms.carrier, balls, len(count)) == 1) & (count == 1))


def carriers(system: System) -> IntArray:
    """The motion of each body (n,)."""
    return np.arange(len(system.bodies)) if system.mechanisms is None else system.mechanisms.carrier
