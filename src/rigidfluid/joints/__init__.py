"""The joints that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.joints.joint import Joint
from rigidfluid.hookspecs import hookimpl
from rigidfluid.joints.ball import Ball
from rigidfluid.joints.hinge import Hinge
from rigidfluid.joints.rod import Rod
from rigidfluid.joints.slider import Slider


@hookimpl
def rigidfluid_joints() -> list[type[Joint]]:
    """The built-in joints."""
    return [Rod, Hinge, Slider, Ball]
