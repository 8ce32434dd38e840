"""Work of the actuators that prescribe the relative motion in mechanisms, contacts and fluid apart."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.motions import kinematics_now
from rigidfluid.core.mechanics.time_scheme import momentum
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist


class BodiesAfter(NamedTuple):
    """Pose and twist of the bodies after a step of this ``size`` [time]."""

    pose: Pose
    twist: Twist
    size: float


def actuator_work(system: System, state: State, end: BodiesAfter, kinematics: Kinematics) -> float:
    """Work ∫ g · (dP - W dt) over a step by the mean of g, P the bodies' momenta, W weight and applied wrenches
    [energy].

    The work of g against contacts and fluid added, it is the actuators' ∫ g · (dP/dt - F) dt: in the power of F · (G u
    + g) the free motions balance their share by Newton–Euler's equations. ``state`` is that at the start,
    ``end`` that at the end, with the bodies' ``kinematics`` there.
    """
    if not system.motions.driven:
        return 0.0
    before = kinematics_now(system, state)
    gained: FloatArray = momentum(system.mass, system.inertia, end.pose, end.twist)
    gained = gained - momentum(system.mass, system.inertia, state.pose, state.twist)
    gained[:, : system.dimension] -= end.size * system.weight
    if state.applied is not None:
        gained -= end.size * flat(state.applied)
    return 0.5 * float(np.sum((before.relative_twist + kinematics.relative_twist) * gained))
