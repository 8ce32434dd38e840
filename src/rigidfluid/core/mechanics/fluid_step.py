"""Step of the fluid backend: time scheme, mass matrix and load, with the bodies at their poses after contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import applied_wrench, weights
from rigidfluid.core.mechanics.rigid import lab_inertia, turned
from rigidfluid.core.mechanics.time_scheme import derivative_weights, extrapolation_weights, newton_euler
from rigidfluid.core.mechanics.wrenches import flat, wrench_of, wrench_sum
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Step, Twist, Wrench


class StepEnd(NamedTuple):
    """End of a step of this ``size`` at a ``time`` [time], with the motions at ``pose`` after an ``impulse`` of
    contacts [force·time | force·length·time]."""

    time: float
    size: float
    pose: Pose
    impulse: Wrench


def step_to(system: System, state: State, end: StepEnd, points: FloatArray | None = None) -> Step:
    """Step from a ``state`` to its ``end``, with the mesh's geometry ``points`` (N + K, d) there, None on the present
    mesh [length]."""
    time, pose, derivative = end.time, end.pose, derivative_weights(end.size, state.past_step)
    kinematics = system.motions.kinematics(pose, time)
    mass_matrix, load = _newton_euler(system, state, end, derivative, kinematics)
    return Step(
        time=time,
        derivative=derivative,
        extrapolation=extrapolation_weights(end.size, state.past_step),
        pose=system.motions.poses(pose, time),
        points=points,
        mass_matrix=mass_matrix,
        load=load,
        prescribed=system.motions.prescribed,
        prescribed_twist=system.prescribed_twist(time),
        impulse=flat(end.impulse),
        load_scale=_load_scale(system, state, end.impulse, derivative),
        turning=np.zeros_like(load),
        kinematics=kinematics,
        links=system.solved_joints.links(pose, time),
        stresslets=system.stresslets,
        boundary_forces=system.boundary_forces,
        cell_errors=system.cell_errors,
    )


class _Moment(NamedTuple):
    """Motions at an earlier time."""

    time: float
    pose: Pose
    twist: Twist


def _newton_euler(
    system: System, state: State, end: StepEnd, derivative: FloatArray, kinematics: Kinematics
) -> tuple[FloatArray, FloatArray]:
    """Mass matrix (N, d+k, d+k) and load (N, d+k) of the motions, with all bodies that they carry."""
    time, size, pose, impulse = end
    past = [_Moment(time - size, state.motions.pose, state.motions.twist)]
    if state.past is not None:
        past.append(_Moment(time - size - state.past.step, state.past.pose, state.past.twist))
    poses, twists = [moment.pose for moment in past], [moment.twist for moment in past]
    pushed = impulse
    if state.applied is not None:
        applied = applied_wrench(system, state, kinematics)
        pushed = wrench_sum(impulse, Wrench(size * applied.force, size * applied.torque))
    pushed = mean_contact_wrench(pushed, _latest_wrench(system, state), state.past_step, derivative)
    pushed = system.solved_joints.with_springs(pushed, pose, time)
    motions, wrench = system.motions, wrench_sum(pushed, weights(system, kinematics))
    inertia = motions.inertia(time)
    mass_matrix, load = newton_euler(motions.mass, inertia, pose, poses, twists, derivative, wrench)
    if motions.driven:
        load[:, system.dimension :] -= _relative_momentum_rate(motions, end, past, derivative)
    return mass_matrix, load


def _latest_wrench(system: System, state: State) -> Wrench:
    """Mean wrench on the motions in the latest step: contacts, applied wrenches, and without a fluid joints, which
    enter the time scheme in the same way."""
    pushed = state.motions.contact
    if state.past is not None and state.past.applied is not None:
        pushed = wrench_sum(pushed, state.past.applied)
    if system.has_fluid:
        return pushed
    return wrench_sum(pushed, wrench_of(state.link.wrench, system.dimension))


def _relative_momentum_rate(
    motions: Motions, end: StepEnd, past: Sequence[_Moment], derivative: FloatArray
) -> FloatArray:
    """Rate d/dt of R h and of R (I - I_new) Rᵀ ω: angular momentum (N, k) by relative motion [force·length]."""
    inertia = motions.inertia(end.time)
    rate = derivative[0] * turned(end.pose.orientation, motions.spin(end.time))
    for weight, (then, there, twist) in zip(derivative[1:], past, strict=False):
        change = lab_inertia(motions.inertia(then) - inertia, there.orientation)
        extra = np.einsum("nij,nj->ni", change, twist.angular_velocity)
        rate = rate + weight * (extra + turned(there.orientation, motions.spin(then)))
    return np.asarray(rate)


def _load_scale(system: System, state: State, impulse: Wrench, derivative: FloatArray) -> float:
    """Hundredth of weight, contacts and applied forces, which cancel each other at rest [force].

    Their sum is rounding there, and no residual can be made small relative to it.
    """
    pushed = derivative[0] * np.linalg.norm(impulse.force[~system.motions.prescribed])
    applied = 0.0 if state.applied is None else np.linalg.norm(state.applied.force)
    return float(0.01 * max(np.linalg.norm(system.weight[~system.prescribed]), pushed, applied))


def mean_contact_wrench(impulse: Wrench, latest: Wrench, past_step: float | None, derivative: FloatArray) -> Wrench:
    """Wrench of the contacts in the time scheme, d₀ Jⁿ⁺¹ - d₂ Jⁿ with J the impulse of a step.

    The scheme differences momentum less the impulses received so far: an impact shorter than the step changes the
    momentum by all of it at once, and not by the two thirds that BDF2 would take for a force. ``impulse`` is Jⁿ⁺¹
    [force·time | force·length·time]; ``latest`` the mean wrench in the step before, of length ``past_step`` [time],
    None at the start; ``derivative`` d₀, d₁, d₂ (3,) [1/time].
    """
    before = past_step or 0.0
    return Wrench(
        derivative[0] * impulse.force - derivative[2] * before * latest.force,
        derivative[0] * impulse.torque - derivative[2] * before * latest.torque,
    )
