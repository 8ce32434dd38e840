"""Components that strokes move in the frame of their mechanism."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.rigid import cross, rotate, rotation_matrices
from rigidfluid.core.mechanics.strokes import Stroke
from rigidfluid.core.model.mechanism import Component, Mechanism
from rigidfluid.core.model.types import Pose, Twist

_ROUNDING = 1e-9


class RigidDisplacement(Protocol):
    """A rigid displacement by a value s(t)."""

    def moved(self, pose: Pose, value: float) -> Pose:
        """Displaced poses of components at ``pose``."""

    def rate(self, moved: Pose, twist: Twist, value: float, rate: float) -> Twist:
        """Twists at the displaced poses ``moved``, of components whose ``twist`` was that before the displacement."""


@dataclass(frozen=True)
class Translation:
    """x + s e, with the unit vector e ``along`` (d,)."""

    along: FloatArray

    def moved(self, pose: Pose, value: float) -> Pose:
        return Pose(pose.position + value * self.along, pose.orientation)

    def rate(self, moved: Pose, twist: Twist, value: float, rate: float) -> Twist:
        return Twist(twist.velocity + rate * self.along, twist.angular_velocity)


@dataclass(frozen=True)
class Rotation:
    """p + R(s)(x - p), with p ``about`` (d,) [length] and s about the unit vector ``axis`` (k,), in 2D (1,)."""

    about: FloatArray
    axis: FloatArray

    def moved(self, pose: Pose, value: float) -> Pose:
        turn = np.tile(value * self.axis, (len(pose.position), 1))
        return Pose(self.about + self._turned(pose.position - self.about, value), rotate(pose.orientation, turn))

    def rate(self, moved: Pose, twist: Twist, value: float, rate: float) -> Twist:
        spin = np.tile(rate * self.axis, (len(moved.position), 1))
        velocity = self._turned(twist.velocity, value) + cross(spin, moved.position - self.about)
        carried = twist.angular_velocity
        return Twist(velocity, spin + (carried if len(self.axis) == 1 else self._turned(carried, value)))

    def _turned(self, vectors: FloatArray, value: float) -> FloatArray:
        start = np.zeros((1, 1)) if len(self.axis) == 1 else np.eye(1, 4)
        return np.asarray(vectors @ rotation_matrices(rotate(start, value * self.axis[None]))[0].T)


@dataclass(frozen=True)
class MovingComponents:
    """The ``components`` (m,) that a ``displacement`` moves as its ``stroke`` says."""

    components: BoolArray
    displacement: RigidDisplacement
    stroke: Stroke


class StrokedMechanism(Mechanism):
    """Components at T₁(s₁(t)) T₂(s₂(t)) … x of their places x, with a rigid displacement T of each stroke.

    A component takes part in the strokes that move it. Points, axes and directions are those where all values are
    zero: a stroke carries along those of the strokes after it, as the joints of a chain do. ``rest``: poses of
    the m components where all values are zero.
    """

    parts: Sequence[Component]
    rest: Pose
    strokes: Sequence[MovingComponents]

    @property
    def components(self) -> Sequence[Component]:
        """The components, in the order of their places."""
        return self.parts

    @cached_property
    def period(self) -> float | None:
        """Longest period of the strokes, if it is a whole multiple of all; else None [time]."""
        periods = [math.inf if one.stroke.period is None else one.stroke.period for one in self.strokes]
        longest = max(periods, default=math.inf)
        if math.isinf(longest):
            return None
        counts = longest / np.array(periods)
        return longest if np.abs(counts - np.round(counts)).max() < _ROUNDING else None

    def placement(self, time: float) -> Pose:
        """Poses of the components by the strokes at this ``time``."""
        return self._moved(time)[0]

    def rate(self, time: float) -> Twist:
        """Twists of the components by the strokes at this ``time``."""
        return self._moved(time)[1]

    def next_corner(self, time: float) -> float:
        """First of the next corners of all strokes [time]."""
        return min((one.stroke.next_corner(time) for one in self.strokes), default=math.inf)

    def _moved(self, time: float) -> tuple[Pose, Twist]:
        """The last stroke acts first, and those before it carry along what it has done."""
        spins = 1 if self.dimension == 2 else 3
        pose, count = self.rest, len(self.rest.position)
        twist = Twist(np.zeros((count, self.dimension)), np.zeros((count, spins)))
        for one in reversed(self.strokes):
            value, rate, moves = one.stroke.value(time), one.stroke.rate(time), one.components[:, None]
            to = one.displacement.moved(pose, value)
            so = one.displacement.rate(to, twist, value, rate)
            pose = Pose(np.where(moves, to.position, pose.position), np.where(moves, to.orientation, pose.orientation))
            velocity = np.where(moves, so.velocity, twist.velocity)
            twist = Twist(velocity, np.where(moves, so.angular_velocity, twist.angular_velocity))
        return pose, twist
