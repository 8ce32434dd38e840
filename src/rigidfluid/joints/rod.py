"""Two bodies that move as if they were one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from rigidfluid.core.joints.constraints import Constraint, SameOrientation, SamePoint
from rigidfluid.core.joints.joint import Joint
from rigidfluid.core.joints.markers import MarkerPair


class Rod(Joint):
    """No relative motion."""

    name: ClassVar[str] = "rod"

    def constraints(self, name: str, markers: MarkerPair) -> Sequence[Constraint]:
        """The same point and orientation."""
        return [SamePoint(name, markers, np.eye(self.dimension)), SameOrientation(name, markers)]
