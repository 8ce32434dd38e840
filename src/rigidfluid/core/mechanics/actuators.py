"""What drives the relative motion in mechanisms, by all that its bodies resist it with but contacts and fluid."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.motions import kinematics_now
from rigidfluid.core.mechanics.time_scheme import momentum
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import FloatArray, Kinematics, Pose, Twist


def actuator_work(
    system: System, state: State, kinematics: Kinematics | None, pose: Pose, twist: Twist, size: float
) -> float:
    """∫ g · (dP - W dt) over a step by the mean of g, P the bodies' momenta, W their weight and what acts from outside.

    With what g does against contacts and fluid it is the work ∫ g · (dP/dt - F) dt of what holds the bodies to their
    relative motion: in the power of F · (G u + g) the free motions have no share that Newton–Euler's equations do not
    balance.

    Parameters
    ----------
    system : System
        Bodies and mechanisms.
    state : State
        At the start of the step.
    kinematics : Kinematics or None
        At its end.
    pose, twist : Pose, Twist
        Of the bodies at its end.
    size : float
        How long it is [time].

    Returns
    -------
    float
        Zero where nothing moves relatively [energy].
    """
    before = kinematics_now(system, state)
    if before is None or kinematics is None or system.mechanisms is None or not system.mechanisms.driven:
        return 0.0
    gained: FloatArray = momentum(system.mass, system.inertia, pose, twist)
    gained = gained - momentum(system.mass, system.inertia, state.pose, state.twist)
    gained[:, : system.dimension] -= size * system.weight
    if state.applied is not None:
        gained -= size * flat(state.applied)
    return 0.5 * float(np.sum((before.given + kinematics.given) * gained))
