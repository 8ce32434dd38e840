"""Loads, accelerations, inverse masses and extents of the motions that carry a system's bodies."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.rigid import lab_inertia
from rigidfluid.core.mechanics.wrenches import flat, nothing, wrench_of, wrench_sum
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist, Wrench


def body_load(system: System, state: State) -> Wrench:
    """Weight and applied wrenches on the bodies, n rows."""
    weight = _body_weight(system)
    return weight if state.applied is None else wrench_sum(weight, state.applied)


def weights(system: System, kinematics: Kinematics) -> Wrench:
    """Weight of all that each motion carries, and its torque about the centre of mass, N rows."""
    return kinematics.motion_wrench(_body_weight(system))


def _body_weight(system: System) -> Wrench:
    """Weight of the bodies, without a torque about their centres, n rows."""
    return Wrench(system.weight, np.zeros_like(system.inertia[:, 0]))


def applied_wrench(system: System, state: State, kinematics: Kinematics) -> Wrench:
    """Mean applied wrench on the motions in the step from ``state`` to ``kinematics`` at its end, N rows."""
    if state.applied is None:
        return nothing(state.motions.pose)
    start, end = (flat(at.motion_wrench(state.applied)) for at in (kinematics_now(system, state), kinematics))
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
    return system.motions.poses(motions, time), system.motions.kinematics(motions, time).component_twist(twist)


def kinematics_now(system: System, state: State) -> Kinematics:
    """Kinematics G and g of a state, read from its poses and twists."""
    return system.motions.kinematics_between(state.motions.pose, state.pose, state.motions.twist, state.twist)


def accelerations(system: System, state: State, linear: FloatArray, angular: FloatArray) -> FloatArray:
    """Accelerations of the motions (N, d+k) in the latest step, less the share of contacts, plus that of wrenches
    applied since; at the start those by weight and applied wrenches [length/time² | rad/time²]. ``linear`` and
    ``angular`` are `own_inverse_masses`."""
    if state.past is None:
        return _acceleration(linear, angular, outer_load(system, state))
    rate = (flat(state.motions.twist) - flat(state.past.twist)) / state.past.step
    rate -= _acceleration(linear, angular, state.motions.contact)
    if state.applied is None:
        return rate
    return rate + _acceleration(linear, angular, newly_applied(system, state))


def body_accelerations(system: System, state: State, time: float, size: float) -> FloatArray:
    """Accelerations of the bodies (n, d+k) with the motions that carry them, and the mean rate of the relative velocity
    from ``time`` on over ``size`` [length/time² | rad/time²]."""
    rate, motions = accelerations(system, state, *own_inverse_masses(system, state)), system.motions
    now, later = (motions.kinematics(state.motions.pose, when) for when in (time, time + size))
    return now.body_rates(rate, state.motions.twist, (later.relative_twist - now.relative_twist) / size)


def _acceleration(linear: FloatArray, angular: FloatArray, wrench: Wrench) -> FloatArray:
    """Acceleration M⁻¹ W of the motions by a wrench W on them (N, d+k)."""
    by_force = np.einsum("nij,nj->ni", linear, wrench.force)
    return np.concatenate([by_force, np.einsum("nij,nj->ni", angular, wrench.torque)], axis=1)


def own_inverse_masses(system: System, state: State) -> tuple[FloatArray, FloatArray]:
    """Inverse mass (N, d, d), with the added mass of bodies, and inverse inertia (N, k, k) of each motion alone in the
    lab frame, zero for prescribed motions [1/mass | 1/(mass·length²)]."""
    own = system.mass[:, None, None] * np.eye(system.dimension)
    mass = own + lab_inertia(system.added_mass, state.pose.orientation)
    free = ~system.motions.prescribed[:, None, None]
    linear, angular = system.motions.inverse_masses(mass, state.pose, state.motions.pose.position)
    return free * linear, free * angular


def reaches(system: System) -> tuple[FloatArray, FloatArray]:
    """Largest bounding radius of the bodies of each motion, and the distance of its farthest point from its centre of
    mass, (N,) each [length]."""
    return system.motions.reaches(system.bounding_radii)


def twist_arms(system: System) -> FloatArray:
    """Factors (N, d+k) that turn components of twists into velocities: 1, and for angular ones the distance of the
    motion's farthest point [1 | length]."""
    farthest, d = reaches(system)[1], system.dimension
    return np.repeat([np.ones_like(farthest), farthest], [d, 1 if d == 2 else 3], axis=0).T


def round_motions(system: System) -> BoolArray:
    """Tell whether a motion is that of a single ball, which turns in its place (N,)."""
    count = np.bincount(system.motions.carrier)
    return np.asarray((system.motions.sums(system.balls.astype(float)) == 1) & (count == 1))
