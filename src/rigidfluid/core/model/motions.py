"""The motions of a system, and how they carry its bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.dynamics import BodyDynamics, ImpulsiveDynamics, MotionDynamics
from rigidfluid.core.model.kinematics import Kinematics
from rigidfluid.core.model.state import MotionState
from rigidfluid.core.model.types import Pose, Twist, Wrench


class Motions(Protocol):
    """The N motions of a system, and how they carry its n bodies.

    ``names``: those of the mechanisms, which are the last of the motions. ``carrier`` (n,): the motion of each body.
    ``prescribed`` (N,): whether a motion's twist is. ``mass`` (N,): sum over all that a motion carries.
    ``pose``, ``twist``: those of the motions at the start. ``driven_motions`` (N,): whether a motion's bodies move
    relatively to each other; ``driven``: whether any do.
    """

    names: tuple[str, ...]
    carrier: IntArray
    prescribed: BoolArray
    mass: FloatArray
    pose: Pose
    twist: Twist
    driven_motions: BoolArray
    driven: bool

    def poses(self, motions: Pose, time: float) -> Pose:
        """Pose of the bodies, with the ``motions`` at this pose."""

    def kinematics(self, motions: Pose, time: float) -> Kinematics:
        """G and g, with the ``motions`` at this pose."""

    def kinematics_between(self, motions: Pose, bodies: Pose, motion: Twist, body: Twist) -> Kinematics:
        """G and g, read from the poses of motions and bodies, and from the twists ``motion`` and ``body`` of these."""

    def inertia(self, time: float) -> FloatArray:
        """Inertia of all that a motion carries, about its centre of mass and in its frame, (N, k, k) [mass·length²]."""

    def inverse_masses(self, mass: FloatArray, bodies: Pose, centre: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inverse mass (N, d, d) and inverse inertia (N, k, k) of the motions in the lab frame, with ``mass`` (n, d, d)
        of the bodies there and ``centre`` (N, d) of the motions [1/mass | 1/(mass·length²)]."""

    def spin(self, time: float) -> FloatArray:
        """Angular momentum of the relative motion, in the motions' frames, (N, k) [mass·length²/time]."""

    def reaches(self, radii: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Largest of the bounding ``radii`` (n,) of the bodies of each motion, and the distance of its farthest point
        from its centre of mass, (N,) each [length]."""

    def sums(self, rows: FloatArray) -> FloatArray:
        """Sums of ``rows`` (n, …) over the bodies that each motion carries, (N, …)."""

    def least(self, values: FloatArray) -> FloatArray:
        """Least of ``values`` (n,) of the bodies that each motion carries, (N,)."""

    def next_corner(self, time: float) -> float:
        """The first time after this at which the rate of a relative motion jumps; infinite without one [time]."""

    def dry_dynamics(
        self,
        now: MotionState,
        load: Wrench,
        arms: FloatArray,
        start: float,
        prescribed_twist: Callable[[float], FloatArray],
    ) -> ImpulsiveDynamics:
        """Dynamics of the motions from ``now`` on without a fluid, with a constant ``load`` on the bodies, whose
        farthest points are ``arms`` (n,) from their centres [length]; ``prescribed_twist`` gives the twist (N, d+k) of
        prescribed motions from a time since the ``start`` [time]."""

    def carry(self, motions: MotionDynamics, start: float, load: Wrench | None = None) -> BodyDynamics:
        """Dynamics of the bodies on these ``motions`` from ``start`` on [time]; ``load``: that of `dry_dynamics`, whose
        torque about the motions' centres may change, None where the motions know all of it."""

    def starting_with(self, twist: Twist) -> Motions:
        """The same motions with another ``twist`` at the start."""
