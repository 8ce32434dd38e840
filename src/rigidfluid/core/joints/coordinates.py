"""Coordinates of joints: one number that tells where the first body is seen from the second."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable
from math import inf, tau
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from rigidfluid.core.geometry.answers import number
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import Guarded, gives
from rigidfluid.core.joints.joint_answers import directions, levers
from rigidfluid.core.joints.markers import PlacedPair


class Coordinate(metaclass=Guarded):
    """A number that tells where the first marker is seen from the second, zero at the start.

    Springs, dampers and drives of a joint act on it, and ``joints.csv`` has a column of its ``name``, in the ``unit``.
    Differences are taken without whole periods, if it is the same again after a ``period``, as an angle is.
    """

    kind: ClassVar[str] = "coordinate"
    name: ClassVar[str]
    unit: ClassVar[str]
    period: ClassVar[float] = inf

    @abstractmethod
    @gives(number())
    def value(self, at: PlacedPair) -> float:
        """Value with the markers at ``at`` [unit]."""

    @abstractmethod
    @gives(directions)
    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        """Matrices E (1, d) and A (1, k) of its rate E (v₁ - v₂) + A (ω₁ - ω₂), v the velocities of the points."""

    @gives(levers)
    def levers(self, at: PlacedPair) -> FloatArray:
        """Levers (2, d, k), about both centres of mass, of the points whose velocities v are: the markers', unless said
        otherwise [length]."""
        return at.levers


class Angle(Coordinate):
    """Angle of the first marker seen from the second, counter-clockwise about the last axis."""

    name: ClassVar[str] = "angle"
    unit: ClassVar[str] = "rad"
    period: ClassVar[float] = tau

    def value(self, at: PlacedPair) -> float:
        return at.angle

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return np.zeros((1, len(at.gap))), at.spin_axis[None]


class Displacement(Coordinate):
    """Displacement of the first point from the second along the second marker's last axis.

    The axis turns with the second body: the rate is of the first point against the second body there.
    """

    name: ClassVar[str] = "displacement"
    unit: ClassVar[str] = "length"

    def value(self, at: PlacedPair) -> float:
        return float(at.axes[1][:, -1] @ at.gap)

    def directions(self, at: PlacedPair) -> tuple[FloatArray, FloatArray]:
        return at.axes[1][:, -1][None], np.zeros((1, at.levers.shape[-1]))

    def levers(self, at: PlacedPair) -> FloatArray:
        return at.levers_at_first


@runtime_checkable
class Drive(Protocol):
    """A coordinate as a function of time; ``period``: after that it repeats itself, None where it does not [time]."""

    period: float | None

    def value(self, time: float) -> float:
        """Value of the coordinate [length | rad]."""

    def rate(self, time: float) -> float:
        """Rate of the value, before a corner [length/time | rad/time]."""

    def next_corner(self, time: float) -> float:
        """First time after this at which the rate jumps; infinite where it never does [time]."""


def units_by_name(coordinates: Iterable[Coordinate | None]) -> dict[str, str]:
    """Units of coordinates by name, those of angles before all others and in any case."""
    return {Angle.name: Angle.unit} | {one.name: one.unit for one in coordinates if one is not None}
