"""What drives the relative motion in mechanisms."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.fluid_step import mean_push
from rigidfluid.core.mechanics.kinematics import component_twist
from rigidfluid.core.mechanics.time_scheme import derivative_weights, newton_euler
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Kinematics, Pose, Twist, Wrench


def actuator_power(
    system: System,
    state: State,
    times: tuple[float, float],
    kinematics: Kinematics | None,
    pose: Pose,
    twist: Twist,
    impulse: Wrench,
    by_fluid: Wrench,
) -> float:
    """g · (dP/dt - F) at the end of a step, P the bodies' momenta and F all that acts on them from without.

    Contacts are left out, as the path has their part in it, which may change fast within a step.

    Parameters
    ----------
    system : System
        Bodies and mechanisms.
    state : State
        At the start of the step.
    times : (float, float)
        When it starts and ends [time].
    kinematics : Kinematics or None
        At its end.
    pose, twist : Pose, Twist
        Of the bodies there.
    impulse, by_fluid : Wrench
        On the bodies, of contacts in the step [force·time | force·length·time] and of the fluid at its end.

    Returns
    -------
    float
        Zero where nothing is driven relatively [energy/time].
    """
    mechanisms = system.mechanisms
    if mechanisms is None or kinematics is None or not mechanisms.driven:
        return 0.0
    derivative = derivative_weights(times[1] - times[0], state.past_step)
    poses, twists = [state.pose], [state.twist]
    if state.past is not None:
        earlier = times[0] - state.past.step
        poses.append(mechanisms.poses(state.past.pose, earlier))
        twists.append(component_twist(mechanisms.at(state.past.pose, earlier), state.past.twist))
    pushed = mean_push(impulse, state.contact_wrench, state.past_step, derivative)
    acting = Wrench(pushed.force + system.weight + by_fluid.force, pushed.torque + by_fluid.torque)
    masses, load = newton_euler(system.mass, system.inertia, pose, poses, twists, derivative, acting)
    driving = np.einsum("nij,nj->ni", masses, flat(twist)) - load
    return float(np.sum(kinematics.given * driving))
