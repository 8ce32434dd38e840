"""Links between motions, and of motions to the ground: joints, held directions, springs and dampers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from rigidfluid.core.model.types import BoolArray, FloatArray, Links, Pose, Twist, Wrench


@dataclass(frozen=True, slots=True)
class GroundLink:
    """Link of one ``body`` to its place at the start: its velocities (d+k,) that are ``held`` are zero.

    On the others act springs, -``stiffness`` · displacement, and dampers, -``damping`` · velocity, along fixed axes.
    Rotations in 3D are those about the axes: their displacement is the rotation vector. ``rest`` (d,): where the
    springs do not pull, None where that is at the start [length].
    """

    name: str
    body: int
    held: BoolArray
    stiffness: FloatArray
    damping: FloatArray
    rest: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class LinkReading:
    """Reading of one joint or ground link in a state: by how much its points are apart, ``gap`` [length]; ``value`` of
    its ``coordinate``, by name, and the ``rate`` of that, None and NaN where it has none [length | rad, per time];
    ``force`` (d,) and ``torque`` (k,) on its first body, about the point of the joint [force | force·length]."""

    name: str
    gap: float
    coordinate: str | None
    value: float
    rate: float
    force: FloatArray
    torque: FloatArray


class Linkage(Protocol):
    """The joints of a system on its N motions.

    ``linked`` (N,): which motions have links at all. ``frequency``: of the stiffest spring with the masses that it
    moves, without a fluid, or its rate against a fluid without inertia; 0 without springs [rad/time]. ``driven``:
    whether anything moves as it is told, so that rates and the power of springs may not be zero.
    ``coordinates``: units of the joints' coordinates by name, angles before all others and in any case.
    """

    linked: BoolArray
    frequency: float
    driven: bool
    coordinates: Mapping[str, str]

    def next_corner(self, time: float) -> float:
        """The first time after this at which rates of links jump; infinite if there is none [time]."""

    def links(self, motions: Pose, time: float) -> Links:
        """C, rates and compliances, where the ``motions`` are there."""

    def closed(self, motions: Pose, time: float) -> Pose:
        """The nearest poses at which the joints fit exactly, each motion moved the less the more mass it has."""

    def misfit(self, motions: Pose, time: float) -> FloatArray:
        """Constraint violation of rigid links, a row for each [length | rad]."""

    def tolerance(self, motions: Pose) -> FloatArray:
        """Constraint violations that are rounding there, a row for each [length | rad]."""

    def spring_wrench(self, motions: Pose, time: float) -> Wrench:
        """Wrench of springs on the motions, N rows."""

    def spring_energy(self, motions: Pose, time: float) -> float:
        """Energy stored in springs [energy]."""

    def spring_power(self, motions: Pose, time: float) -> float:
        """Power of prescribed motion against springs [energy/time]."""

    def readings(self, bodies: Pose, twist: Twist, time: float, force: FloatArray | None) -> list[LinkReading]:
        """Readings of all joints and then of all ground links; ``bodies``, ``twist``: of the n bodies; ``force`` (c,):
        of the rows, None where it is not known yet."""

    def following(self, controlled_twist: Callable[[float], FloatArray]) -> Linkage:
        """The same joints where given motions are other ones from now on, (N, d+k) at a time."""
