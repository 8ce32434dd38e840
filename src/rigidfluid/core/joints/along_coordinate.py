"""Drive, damper and spring of a joint's coordinate."""

from __future__ import annotations

from dataclasses import dataclass
from math import remainder

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.constraints import Constraint
from rigidfluid.core.joints.coordinates import Coordinate, Drive
from rigidfluid.core.joints.markers import MarkerPair, Markers, PlacedPair, add_relative_rows
from rigidfluid.core.model.types import Pose, Wrench


@dataclass(frozen=True)
class _AlongCoordinate(Constraint):
    """Acts along a coordinate."""

    coordinate: Coordinate

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return self.coordinate.directions(at)

    def levers(self, at: PlacedPair) -> FloatArray:
        return self.coordinate.levers(at)


@dataclass(frozen=True)
class DrivenCoordinate(_AlongCoordinate):
    """The coordinate is that of a drive; whole periods of difference are none."""

    drive: Drive

    @property
    def compliance(self) -> FloatArray:
        return np.zeros(1)

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.array([remainder(self.coordinate.value(at) - self.drive.value(time), self.coordinate.period)])

    def rate(self, time: float) -> FloatArray:
        return np.array([self.drive.rate(time)])


@dataclass(frozen=True)
class CoordinateDamper(_AlongCoordinate):
    """Resists the rate of the coordinate."""

    damping: float

    @property
    def compliance(self) -> FloatArray:
        return np.array([1.0 / self.damping])

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.zeros(0)


class CoordinateSpring:
    """½ ``stiffness`` (q - ``rest``)² of the coordinate q."""

    def __init__(self, markers: MarkerPair, coordinate: Coordinate, stiffness: float, rest: float) -> None:
        self._bodies, self._markers = markers.bodies, Markers([markers], len(markers.first.point))
        self._coordinate, self._stiffness, self._rest = coordinate, stiffness, rest

    def energy(self, pose: Pose) -> float:
        return 0.5 * self._stiffness * (self._coordinate.value(self._placed(pose)) - self._rest) ** 2

    def add_wrench(self, pose: Pose, wrench: Wrench) -> None:
        at = self._placed(pose)
        along, about = self._coordinate.directions(at)
        force = -self._stiffness * (self._coordinate.value(at) - self._rest)
        for sign, body, lever in zip((1.0, -1.0), self._bodies, self._coordinate.levers(at), strict=True):
            if body is not None:
                wrench.force[body] += sign * force * along[0]
                wrench.torque[body] += sign * force * (along @ lever + about)[0]

    def stretch(self, pose: Pose) -> FloatArray:
        at, (count, d) = self._placed(pose), pose.position.shape
        rows = np.zeros((1, count, d + at.levers.shape[-1]))
        add_relative_rows(self._bodies, self._coordinate.levers(at), self._coordinate.directions(at), rows)
        return np.asarray(np.sqrt(self._stiffness) * rows)

    def _placed(self, pose: Pose) -> PlacedPair:
        return self._markers.placed(pose)[0]
