"""Constraints and springs of one joint or ground link, and its reading in a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.joints.constraints import Constraint, SamePoint
from rigidfluid.core.joints.markers import PlacedPair
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.linkage import LinkReading
from rigidfluid.core.model.types import FloatArray, Pose, Twist


@dataclass(frozen=True, slots=True)
class LinkParts:
    """The rows and springs of a link named ``name`` on its ``first`` body, joined to the ``second`` one or, None, to
    the ground; ``has_angle``: whether it is a hinge, and then its first rows are those of its markers."""

    name: str
    first: int
    second: int | None
    constraints: Sequence[Constraint]
    springs: Sequence[Spring]
    has_angle: bool

    @property
    def rows(self) -> int:
        """Number of rows."""
        return sum(len(one.compliance) for one in self.constraints)

    def reading(
        self, placed: Sequence[PlacedPair], bodies: Pose, twist: Twist, time: float, force: FloatArray
    ) -> LinkReading:
        """Gap, angle, force and torque of the link at poses ``bodies``, with the markers of its constraints ``placed``
        and the ``force`` of its rows (r,)."""
        held, torque = self._constraint_wrench(placed, force)
        pull = nothing(bodies)
        for spring in self.springs:
            spring.add_wrench(bodies, pull)
        pairs = list(zip(self.constraints, placed, strict=True))
        gaps = [one.misfit(at, time) for one, at in pairs if isinstance(one, SamePoint)]
        angle, rate = self._turn(placed[0], twist) if self.has_angle else (np.nan, np.nan)
        return LinkReading(
            name=self.name,
            gap=float(np.linalg.norm(np.concatenate([np.zeros(0), *gaps]))),
            angle=angle,
            rate=rate,
            force=held + pull.force[self.first],
            torque=torque + pull.torque[self.first],
        )

    def _constraint_wrench(self, placed: Sequence[PlacedPair], force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and torque of the rows on the first body."""
        pulled, turned, start = np.zeros(1), np.zeros(1), 0
        for one, at in zip(self.constraints, placed, strict=True):
            own = force[start : (start := start + len(one.compliance))]
            along, about = one.directions(at)
            pulled, turned = pulled + own @ along, turned + own @ about
        return pulled, turned

    def _turn(self, hinge: PlacedPair, twist: Twist) -> tuple[float, float]:
        """Angle and rate of the first body seen from the second."""
        spins = [0.0 if body is None else twist.angular_velocity[body] for body in (self.first, self.second)]
        return hinge.angle, float(hinge.spin_axis @ (spins[0] - spins[1]))
