"""What a fluid backend is asked for: one step, with the bodies where their contacts took them."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.time_scheme import derivative_weights, extrapolation_weights, newton_euler
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray, Mesh, Pose, Step, Wrench


def step_to(
    system: System, state: State, time: float, size: float, pose: Pose, impulse: Wrench, mesh: Mesh | None
) -> Step:
    """The step of this ``size`` that ends at ``time`` with the bodies at ``pose``, after ``impulse`` by contacts."""
    derivative = derivative_weights(size, state.past_step)
    poses, twists = [state.pose], [state.twist]
    if state.past is not None:
        poses.append(state.past.pose)
        twists.append(state.past.twist)
    pushed = _mean_push(state, impulse, derivative)
    wrench = Wrench(pushed.force + system.weight, pushed.torque)
    mass_matrix, load = newton_euler(system.mass, system.inertia, pose, poses, twists, derivative, wrench)
    return Step(
        time=time,
        derivative=derivative,
        extrapolation=extrapolation_weights(size, state.past_step),
        pose=pose,
        points=None if mesh is None else mesh.points,
        mass_matrix=mass_matrix,
        load=load,
        controlled=system.controlled,
        controlled_twist=system.controlled_twist(time),
        impulse=flat(impulse),
        load_scale=_load_scale(system, impulse, derivative),
        turning=np.zeros_like(load),
    )


def _load_scale(system: System, impulse: Wrench, derivative: FloatArray) -> float:
    """A hundredth of weight and contacts, which cancel each other at rest [force].

    What remains of them is rounding, and no residual can be made small beside it.
    """
    free = ~system.controlled
    pushed = derivative[0] * np.linalg.norm(impulse.force[free])
    return float(0.01 * max(np.linalg.norm(system.weight[free]), pushed))


def _mean_push(state: State, impulse: Wrench, derivative: FloatArray) -> Wrench:
    """The contacts' wrench as the time scheme sees it, d₀ Jⁿ⁺¹ - d₂ Jⁿ with J the impulse of a step.

    It is what differencing momentum less the impulses received so far comes to: an impact shorter than the step changes
    the momentum by all of it at once, and not by the two thirds that BDF2 would take for a force.
    """
    latest, before = state.contact_wrench, state.past_step or 0.0
    return Wrench(
        derivative[0] * impulse.force - derivative[2] * before * latest.force,
        derivative[0] * impulse.torque - derivative[2] * before * latest.torque,
    )
