"""Motions of bodies that each are a motion of their own."""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import copy

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.dynamics import DryDynamics, Turning
from rigidfluid.core.mechanics.rigid import inverse_lab_inertia
from rigidfluid.core.model.dynamics import MotionDynamics
from rigidfluid.core.model.kinematics import EACH_ITS_OWN, EachItsOwn
from rigidfluid.core.model.state import MotionState
from rigidfluid.core.model.types import Pose, Twist, Wrench


class SingleBodies:
    """`Motions` of n bodies without mechanisms: the bodies themselves. With mechanisms they are `CarriedBodies`."""

    names: tuple[str, ...] = ()
    driven: bool = False

    def __init__(self, mass: FloatArray, inertia: FloatArray, prescribed: BoolArray, pose: Pose, twist: Twist) -> None:
        self.mass, self._inertia, self.prescribed, self.pose, self.twist = mass, inertia, prescribed, pose, twist
        self.carrier: IntArray = np.arange(len(mass))
        self.driven_motions: BoolArray = np.zeros(len(mass), dtype=bool)

    def starting_with(self, twist: Twist) -> SingleBodies:
        """The same bodies with another ``twist`` at the start."""
        other = copy(self)
        other.twist = twist
        return other

    def poses(self, motions: Pose, time: float) -> Pose:
        return motions

    def kinematics(self, motions: Pose, time: float) -> EachItsOwn:
        return EACH_ITS_OWN

    def kinematics_between(self, motions: Pose, bodies: Pose, motion: Twist, body: Twist) -> EachItsOwn:
        return EACH_ITS_OWN

    def inertia(self, time: float) -> FloatArray:
        """Inertia of the bodies (n, k, k) [mass·length²]."""
        return self._inertia

    def inverse_masses(self, mass: FloatArray, bodies: Pose, centre: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.asarray(np.linalg.inv(mass)), inverse_lab_inertia(self._inertia, bodies.orientation)

    def spin(self, time: float) -> FloatArray:
        """Zero (n, k): nothing moves relatively."""
        return np.zeros_like(self._inertia[:, 0])

    def sums(self, rows: FloatArray) -> FloatArray:
        return rows

    def least(self, values: FloatArray) -> FloatArray:
        return values

    def reaches(self, radii: FloatArray) -> tuple[FloatArray, FloatArray]:
        return radii, radii

    def next_corner(self, time: float) -> float:
        """Infinite: there are no strokes."""
        return math.inf

    def dry_dynamics(
        self,
        now: MotionState,
        load: Wrench,
        arms: FloatArray,
        start: float,
        prescribed_twist: Callable[[float], FloatArray],
    ) -> DryDynamics:
        turning = Turning(load.torque, arms) if load.torque.any() else None
        own = self.mass, self._inertia, load.force, self.prescribed
        return DryDynamics(now.pose, now.twist, *own, prescribed_twist, turning)

    def carry(self, motions: MotionDynamics, start: float, load: Wrench | None = None) -> MotionDynamics:
        return motions
