"""Members of dynamics that are trivial where each body is a motion of its own."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.model.dynamics import BodyDynamics, LinkWork
from rigidfluid.core.model.kinematics import EACH_ITS_OWN, Kinematics
from rigidfluid.core.model.state import MotionState
from rigidfluid.core.model.types import Twist, Wrench


class OwnMotions:
    """Base of dynamics whose bodies are its motions, without joints: it completes what is to be a `BodyDynamics`."""

    kinematics: Kinematics = EACH_ITS_OWN

    @property
    def motion_twist(self: BodyDynamics) -> Twist:
        """Present twist."""
        return self.twist

    @property
    def link_work(self: BodyDynamics) -> LinkWork:
        """No work of joints."""
        return LinkWork(np.zeros(0), np.zeros_like(flat(nothing(self.pose))), 0.0, 0.0)

    def motions(self: BodyDynamics, impulse: Wrench) -> MotionState:
        """The bodies themselves, after the ``impulse`` of contacts on them."""
        return MotionState(self.pose, self.twist, impulse, nothing(self.pose))

    def prescribed_part(self: BodyDynamics, prescribed: BoolArray) -> Twist:
        """Twists, valid where a body is prescribed."""
        return self.twist
