"""Constraints of joints, held directions and dampers on the relative motion of two bodies, or of a body and the
ground."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.answers import rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import Guarded, gives
from rigidfluid.core.joints.joint_answers import column, directions, levers, misfit
from rigidfluid.core.joints.markers import MarkerPair, PlacedPair, add_relative_rows


@dataclass(frozen=True)
class Constraint(metaclass=Guarded):
    """Rows on the motion of the first marker relative to the second, E (v₁ - v₂) + A (ω₁ - ω₂) + compliance · force =
    rate, with v the velocities of the points; rigid, and at rate zero, unless said otherwise."""

    kind: ClassVar[str] = "constraint"
    joins_points: ClassVar[bool] = False
    """Tell whether the misfit is by how much the points are apart that it holds together [length]."""

    name: str
    markers: MarkerPair

    @abstractmethod
    @gives(directions)
    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        """Matrices E (r, d) and A (r, k) with the markers at ``at``."""

    @abstractmethod
    @gives(misfit)
    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        """Constraint violation c(q) (r,), empty for dampers; its rate is that of the rows where it is zero [length |
        rad]."""

    @property
    @abstractmethod
    @gives(column)
    def compliance(self) -> FloatArray:
        """Compliance of each row (r,), zero for rigid rows, 1/damping for those of dampers."""

    @gives(rows(lambda part, time: part.compliance.shape))
    def rate(self, time: float) -> FloatArray:
        """Prescribed rate of each row (r,) [length/time | rad/time]."""
        return np.zeros_like(self.compliance)

    @gives(levers)
    def levers(self, at: PlacedPair) -> FloatArray:
        """Levers (2, d, k), about both centres of mass, of the points whose velocities v are: the markers', unless said
        otherwise [length]."""
        return at.levers

    def add_rows(self, at: PlacedPair, rows: FloatArray) -> None:
        """Put those on the bodies' twists into ``rows`` (r, n, d+k), zero before."""
        add_relative_rows(self.markers.bodies, self.levers(at), self.directions(at), rows)


@dataclass(frozen=True)
class SamePoint(Constraint):
    """The points stay together along ``along`` (r, d), axes of space."""

    joins_points: ClassVar[bool] = True

    along: FloatArray

    @property
    def compliance(self) -> FloatArray:
        return np.zeros(len(self.along))

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return self.along, np.zeros((len(self.along), self.markers.spins))

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.asarray(self.along @ at.gap)


@dataclass(frozen=True)
class SameOrientation(Constraint):
    """No relative rotation. The misfit in 3D is sin θ of the rotation between the axes, along its axis."""

    @property
    def compliance(self) -> FloatArray:
        return np.zeros(self.markers.spins)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return np.zeros((self.markers.spins, len(at.gap))), np.eye(self.markers.spins)

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        if self.markers.spins == 1:
            return np.array([at.angle])
        turn = at.axes[0] @ at.axes[1].T
        skew = 0.5 * (turn - turn.T)
        return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


@dataclass(frozen=True)
class SameAxis(Constraint):
    """The third axes stay parallel: no relative rotation about the second's first two, in 3D."""

    @property
    def compliance(self) -> FloatArray:
        return np.zeros(2)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return np.zeros((2, 3)), at.axes[1][:, :2].T

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        first, second = at.axes
        return np.array([-second[:, 1] @ first[:, 2], second[:, 0] @ first[:, 2]])


@dataclass(frozen=True)
class OnAxis(Constraint):
    """The first point stays on the second marker's last axis.

    The axis turns with the second body, so velocities are taken where the first point is: forces on both bodies then
    have one line, however far they have slid.
    """

    joins_points: ClassVar[bool] = True

    @property
    def compliance(self) -> FloatArray:
        return np.zeros(len(self.markers.first.point) - 1)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        across = at.axes[1][:, :-1].T
        return across, np.zeros((len(across), self.markers.spins))

    def levers(self, at: PlacedPair) -> FloatArray:
        return at.levers_at_first

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.asarray(at.axes[1][:, :-1].T @ at.gap)


@dataclass(frozen=True)
class RotationDamper(Constraint):
    """Resists all relative rotation alike."""

    damping: float

    @property
    def compliance(self) -> FloatArray:
        return np.full(self.markers.spins, 1.0 / self.damping)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return np.zeros((self.markers.spins, len(at.gap))), np.eye(self.markers.spins)

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.zeros(0)


@dataclass(frozen=True)
class GroundDamper(Constraint):
    """Resists velocities of a body, ``along`` (r, d+k) of space, by ``damping`` (r,)."""

    along: FloatArray
    damping: FloatArray

    @property
    def compliance(self) -> FloatArray:
        return np.asarray(1.0 / self.damping)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        d = len(at.gap)
        return self.along[:, :d], self.along[:, d:]

    def misfit(self, at: PlacedPair, time: float) -> FloatArray:
        return np.zeros(0)
