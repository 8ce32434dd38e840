"""A point about which a body turns freely, in 3D."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.joints.constraints import Constraint, RotationDamper, SamePoint
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.joints.markers import MarkerPair
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive
from rigidfluid.errors import SceneError


class BallOptions(PartOptions):
    """Keys of a ``[[joint]]`` table with type ``ball``, a ball in its socket: the bodies turn about a point, in 3D."""

    damping: Positive | None = Field(
        default=None, description="Resists relative rotation about any axis; none if not given [force·length·time/rad]"
    )


class Ball(Joint):
    """The points stay together; in 2D it is a hinge, and refused."""

    name: ClassVar[str] = "ball"
    Options: ClassVar[type[PartOptions]] = BallOptions
    needs_point: ClassVar[bool] = True
    options: BallOptions

    def __init__(self, options: BallOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        if dimension == 2:
            raise SceneError("joint.type", "'ball' in 2D", "'hinge', which is the same there", "Set type = 'hinge'.")

    def constraints(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """The same point, and a damper."""
        damping = self.options.damping
        dampers = [] if damping is None else [RotationDamper(name, markers, damping)]
        return [SamePoint(name, markers, np.eye(self.dimension)), *dampers]
