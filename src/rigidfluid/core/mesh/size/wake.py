"""Finer cells in the wakes of moving bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.flow import Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.regions import RefinedCapsule
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose, Twist


class Wake(SizeField):
    """Size field of `[mesh.wake]`: ``size`` [length] where a body was within ``time`` [time] at its present velocity,
    and ``growth`` with the distance from there [1].

    A length would need a direction, which a body at rest does not have: x - time·U shrinks to the body with U.
    """

    name = "wake"

    def __init__(self, time: float, size: float, growth: float, dimension: int) -> None:
        super().__init__(PartOptions(), dimension)
        self.time, self.size, self.growth = time, size, growth

    def edge_length(self, points: FloatArray, around: FluidDomain, flow: Flow) -> FloatArray:
        """Least of size + growth·d over all wakes at distances d, (m,) [length]."""
        longest = np.full(len(points), around.width)
        for capsule in self.behind(around.bodies, around.pose, flow.twist):
            np.minimum(longest, self.size + self.growth * capsule.distance(points), out=longest)
        return longest

    def behind(self, bodies: Sequence[Body], pose: Pose, twist: Twist) -> tuple[RefinedCapsule, ...]:
        """The wakes of all bodies that move, each as wide as the ball around its body."""
        ends = pose.position - self.time * twist.velocity
        found = zip(bodies, pose.position, ends, strict=True)
        return tuple(
            RefinedCapsule(start, end, body.bounding_radius, self.size)
            for body, start, end in found
            if np.linalg.norm(end - start) > self.size
        )
