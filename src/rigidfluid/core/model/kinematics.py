"""Kinematics of bodies on the motions that carry them: body twist = G u + g, motion wrench = Gᵀ body wrench."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
    from rigidfluid.core.model.types import Pose, Twist, Wrench


class Kinematics(Protocol):
    """Kinematics of n bodies on N motions at one moment."""

    @property
    def relative_twist(self) -> FloatArray:
        """Twist g that relative motion adds, (n, d+k), or () where there is none [length/time | rad/time]."""

    @property
    def arm(self) -> FloatArray:
        """Arms (n, d) from the centre of mass of the motion that carries each body to the body's, or () where each is
        its own [length]."""

    def centres(self, bodies: Pose) -> FloatArray:
        """Centres of mass of the motions (N, d), with the ``bodies`` at this pose [length]."""

    def component_twist(self, motion: Twist) -> Twist:
        """Twists G u + g of the bodies, n rows, by those of the motions, N rows."""

    def motion_twist(self, twist: FloatArray) -> FloatArray:
        """Twists (N, d+k) of the motions that give the bodies this ``twist`` (n, d+k)."""

    def motion_wrench(self, wrench: Wrench) -> Wrench:
        """Wrench Gᵀ W on the motions about their centres of mass, N rows, by that on the bodies, n rows."""

    def motion_rows(self, rows: FloatArray) -> FloatArray:
        """Rows C G (c, N, d+k) on the motions of rows C (c, n, d+k) on the bodies."""

    def has_prescribed_part(self, prescribed: BoolArray, twist: Twist) -> BoolArray:
        """Tell whether a body has a prescribed part of its twist (n,), given that ``twist`` and the motions
        ``prescribed`` (N,)."""

    def body_rates(self, rate: FloatArray, motion: Twist, relative_rate: FloatArray) -> FloatArray:
        """Accelerations of the bodies (n, d+k) by the ``rate`` (N, d+k) of the motions' twists, these twists, and the
        rate of g (n, d+k)."""


class EachItsOwn:
    """Kinematics of bodies that each are a motion of their own: G = 1, g = 0; arguments are returned unchanged."""

    relative_twist: FloatArray = np.zeros(())
    arm: FloatArray = np.zeros(())

    def centres(self, bodies: Pose) -> FloatArray:
        return bodies.position

    def component_twist(self, motion: Twist) -> Twist:
        return motion

    def motion_twist(self, twist: FloatArray) -> FloatArray:
        return twist

    def motion_wrench(self, wrench: Wrench) -> Wrench:
        return wrench

    def motion_rows(self, rows: FloatArray) -> FloatArray:
        return rows

    def has_prescribed_part(self, prescribed: BoolArray, twist: Twist) -> BoolArray:
        return prescribed

    def body_rates(self, rate: FloatArray, motion: Twist, relative_rate: FloatArray) -> FloatArray:
        return rate


EACH_ITS_OWN = EachItsOwn()
