"""Constraints and springs of one joint or ground link, and its reading in a state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.core.joints.coordinates import Coordinate
from rigidfluid.core.joints.markers import PlacedPair
from rigidfluid.core.joints.springs import Spring
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.joints import LinkReading
from rigidfluid.core.model.types import Pose, Twist


@dataclass(frozen=True, slots=True)
class LinkParts:
    """The rows and springs of a link named ``name`` on its ``first`` body, joined to the ``second`` one or, None, to
    the ground; ``coordinate``: of its markers, which are those of its first constraint."""

    name: str
    first: int
    second: int | None
    constraints: Sequence[Constraint]
    springs: Sequence[Spring]
    coordinate: Coordinate | None

    @property
    def rows(self) -> int:
        """Number of rows."""
        return sum(len(one.compliance) for one in self.constraints)

    def reading(
        self, placed: Sequence[PlacedPair], bodies: Pose, twist: Twist, time: float, force: FloatArray
    ) -> LinkReading:
        """Gap, coordinate, force and torque of the link at poses ``bodies``, with the markers of its constraints
        ``placed`` and the ``force`` of its rows (r,)."""
        held, torque = self._constraint_wrench(placed, force)
        spring_force, spring_torque = self._spring_wrench(placed, bodies)
        pairs = list(zip(self.constraints, placed, strict=True))
        gaps = [one.misfit(at, time) for one, at in pairs if one.joins_points]
        value, rate, seen = np.nan, np.nan, self.coordinate
        if seen is not None:
            value, rate = self._value_and_rate(seen, placed[0], twist)
        return LinkReading(
            name=self.name,
            gap=float(np.linalg.norm(np.concatenate([np.zeros(0), *gaps]))),
            coordinate=None if seen is None else seen.name,
            value=value,
            rate=rate,
            force=held + spring_force,
            torque=torque + spring_torque,
        )

    def _spring_wrench(self, placed: Sequence[PlacedPair], bodies: Pose) -> tuple[FloatArray, FloatArray]:
        """Force and torque of the springs on the first body, about its point; without rows that is its centre."""
        wrench = nothing(bodies)
        for spring in self.springs:
            spring.add_wrench(bodies, wrench)
        force, torque = wrench.force[self.first], wrench.torque[self.first]
        return force, torque - placed[0].levers[0].T @ force if placed else torque

    def _constraint_wrench(self, placed: Sequence[PlacedPair], force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force and torque of the rows on the first body."""
        pulled, turned, start = np.zeros(1), np.zeros(1), 0
        for one, at in zip(self.constraints, placed, strict=True):
            own = force[start : (start := start + len(one.compliance))]
            along, about = one.directions(at)
            pulled, turned = pulled + own @ along, turned + own @ about
        return pulled, turned

    def _value_and_rate(self, coordinate: Coordinate, at: PlacedPair, twist: Twist) -> tuple[float, float]:
        (along, about), bodies = coordinate.directions(at), (self.first, self.second)
        shift, spin = np.zeros(along.shape[1]), np.zeros(about.shape[1])
        for sign, body, lever in zip((1.0, -1.0), bodies, coordinate.levers(at), strict=True):
            if body is not None:
                shift += sign * (twist.velocity[body] + lever @ twist.angular_velocity[body])
                spin += sign * twist.angular_velocity[body]
        return coordinate.value(at), float(along[0] @ shift + about[0] @ spin)
