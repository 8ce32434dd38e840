"""Links between motions, and of motions to the ground: joints, held directions, springs and dampers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.dynamics import ImpulsiveDynamics, MotionDynamics
from rigidfluid.core.model.state import LinkLoad, unloaded
from rigidfluid.core.model.types import NO_LINKS, Links, Pose, Twist, Wrench

COORDINATES: Mapping[str, str] = {"angle": "rad"}
"""Coordinates of joints that always have a column in joints.csv, with their units."""


@dataclass(frozen=True, slots=True)
class GroundLink:
    """Link of one ``body`` to its place at the start: its velocities (d+k,) that are ``held`` are zero.

    On the others act springs, -``stiffness`` · displacement, and dampers, -``damping`` · velocity, along fixed axes.
    Rotations in 3D are those about the axes: their displacement is the rotation vector. ``rest`` (d,): the position
    where the springs are relaxed, None for that at the start [length].
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


class Joints(Protocol):
    """The joints of a system on its N motions.

    ``linked`` (N,): whether a motion has links at all; ``clusters`` (N,): equal for motions that joints link, directly
    or over others. ``frequency``: that of the stiffest spring with the masses that it moves, without a fluid, or the
    rate at which it relaxes against a fluid without inertia; 0 without springs [rad/time]. ``driven``: whether motions
    or drives are prescribed, so that rates of links and the power of springs may not be zero. ``coordinates``: units of
    the joints' coordinates by name, that of angles first and always.
    """

    linked: BoolArray
    clusters: IntArray
    frequency: float
    driven: bool
    coordinates: Mapping[str, str]

    def next_corner(self, time: float) -> float:
        """The first time after this at which rates of links jump; infinite if there is none [time]."""

    def links(self, motions: Pose, time: float) -> Links:
        """C, rates and compliances, with the ``motions`` at this pose."""

    def unloaded(self, motions: Pose) -> LinkLoad:
        """Load of the links before the first step."""

    def closed(self, motions: Pose, time: float) -> Pose:
        """The nearest poses at which the joints fit exactly, each motion moved the less the more mass it has."""

    def fitting(self, motions: Pose, twist: Twist, time: float) -> Twist:
        """The ``twist``, N rows, after impulses of the rigid joints that make it satisfy their constraints."""

    def over(self, motions: ImpulsiveDynamics, start: float) -> MotionDynamics:
        """Dynamics of the motions with their joints from ``start`` on [time]."""

    def load(self, links: Links, force: FloatArray, motions: Pose, time: float) -> LinkLoad:
        """Load of the ``links`` with these forces (c,), and of springs, with the ``motions`` at this pose."""

    def with_springs(self, wrench: Wrench, motions: Pose, time: float) -> Wrench:
        """The ``wrench`` on the motions with that of springs, N rows."""

    def spring_energy(self, motions: Pose, time: float) -> float:
        """Energy stored in springs [energy]."""

    def spring_power(self, motions: Pose, time: float) -> float:
        """Power of prescribed motion against springs [energy/time]."""

    def readings(self, bodies: Pose, twist: Twist, time: float, force: FloatArray) -> list[LinkReading]:
        """Readings of all joints and then of all ground links, with the n ``bodies`` at this pose and ``twist`` and the
        forces (c,) of links."""

    def following(self, prescribed_twist: Callable[[float], FloatArray]) -> Joints:
        """The same joints with other prescribed twists (N, d+k) at a time."""


class NoJoints:
    """N motions without joints, held directions and springs: arguments are returned unchanged."""

    frequency: float = 0.0
    driven: bool = False
    coordinates: Mapping[str, str] = COORDINATES

    def __init__(self, motions: int) -> None:
        self.linked: BoolArray = np.zeros(motions, dtype=bool)
        self.clusters: IntArray = np.arange(motions)

    def next_corner(self, time: float) -> float:
        """Infinite: nothing is driven."""
        return math.inf

    def links(self, motions: Pose, time: float) -> Links:
        return NO_LINKS

    def unloaded(self, motions: Pose) -> LinkLoad:
        return unloaded(motions)

    def closed(self, motions: Pose, time: float) -> Pose:
        return motions

    def fitting(self, motions: Pose, twist: Twist, time: float) -> Twist:
        return twist

    def over(self, motions: ImpulsiveDynamics, start: float) -> MotionDynamics:
        return motions

    def load(self, links: Links, force: FloatArray, motions: Pose, time: float) -> LinkLoad:
        """Zero loads."""
        return unloaded(motions)

    def with_springs(self, wrench: Wrench, motions: Pose, time: float) -> Wrench:
        return wrench

    def spring_energy(self, motions: Pose, time: float) -> float:
        return 0.0

    def spring_power(self, motions: Pose, time: float) -> float:
        return 0.0

    def readings(self, bodies: Pose, twist: Twist, time: float, force: FloatArray) -> list[LinkReading]:
        return []

    def following(self, prescribed_twist: Callable[[float], FloatArray]) -> NoJoints:
        return self
