"""All that one joint or ground link is made of, and what can be read from it in a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.mechanics.constraints import Constraint, SamePoint
from rigidfluid.core.mechanics.markers import MarkerPair
from rigidfluid.core.mechanics.springs import Spring
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.linkage import LinkReading
from rigidfluid.core.model.types import FloatArray, Pose, Twist


@dataclass(frozen=True, slots=True)
class LinkParts:
    """The rows and springs of a link named ``name`` on its ``first`` body; ``hinge``: whose angle it is, None of a rod
    and of a ground link."""

    name: str
    first: int
    constraints: Sequence[Constraint]
    springs: Sequence[Spring]
    hinge: MarkerPair | None

    @property
    def rows(self) -> int:
        """How many."""
        return sum(len(one.compliance) for one in self.constraints)

    def reading(self, bodies: Pose, twist: Twist, time: float, force: FloatArray) -> LinkReading:
        """Where the bodies are there, with the ``force`` of its rows (r,)."""
        held, torque = self._held(bodies, force)
        pull = nothing(bodies)
        for spring in self.springs:
            spring.add_wrench(bodies, pull)
        gaps = [one.misfit(bodies, time) for one in self.constraints if isinstance(one, SamePoint)]
        angle, rate = (np.nan, np.nan) if self.hinge is None else _turn(self.hinge, bodies, twist)
        return LinkReading(
            name=self.name,
            gap=float(np.linalg.norm(np.concatenate([np.zeros(0), *gaps]))),
            angle=angle,
            rate=rate,
            force=held + pull.force[self.first],
            torque=torque + pull.torque[self.first],
        )

    def _held(self, bodies: Pose, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and torque of the rows on the first body."""
        pulled, turned = np.zeros(bodies.position.shape[1]), np.zeros(1 if bodies.position.shape[1] == 2 else 3)
        start = 0
        for one in self.constraints:
            own = force[start : (start := start + len(one.compliance))]
            along, about = one.directions(bodies)
            pulled, turned = pulled + own @ along, turned + own @ about
        return pulled, turned


def _turn(hinge: MarkerPair, bodies: Pose, twist: Twist) -> tuple[float, float]:
    """Angle and rate of the first seen from the second."""
    spins = [0.0 if one.body is None else twist.angular_velocity[one.body] for one in (hinge.first, hinge.second)]
    return hinge.angle(bodies), float(hinge.spin_axis(bodies) @ (spins[0] - spins[1]))
