"""Dry dynamics of motions with prescribed relative motion: gyrostats whose inertia changes with time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.rigid import inverse_lab_inertia, is_isotropic, rotate, turned
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.errors import StepRejected

_MOST_ITERATIONS = 50
_ROUNDING = 1e-14


class DrivenDynamics(DryDynamics):
    """Newton–Euler without a fluid for N motions with relative motion in them: L = R (I Rᵀ ω + h) of given I(t) and
    h(t) is constant between kicks, and the orientation follows by the midpoint rule; all else is as in `DryDynamics`.

    ``mechanisms`` give masses, I and h, which is zero without relative motion; ``weight`` (N, d) is constant [force];
    ``start`` is the time at the start [time]; ``prescribed_twist`` gives the twist (N, d+k) of prescribed motions from
    a time since the start.
    """

    def __init__(
        self,
        pose: Pose,
        twist: Twist,
        mechanisms: Motions,
        weight: FloatArray,
        start: float,
        prescribed_twist: Callable[[float], FloatArray],
    ) -> None:
        inertia = mechanisms.inertia(start)
        super().__init__(pose, twist, mechanisms.mass, inertia, weight, mechanisms.prescribed, prescribed_twist)
        self._mechanisms, self._start, self._ahead = mechanisms, start, 0.0
        self._momentum = self._momentum + turned(pose.orientation, mechanisms.spin(start))

    @property
    def twist(self) -> Twist:
        spin = self._rate(self.pose.orientation, self._start + max(self._time, self._ahead))
        return Twist(self._velocity.copy(), spin)

    def begin(self, ahead: float) -> None:
        """Read h(t) no earlier than ``ahead`` after the start [time], so that a jump of h at the start changes the
        rotation."""
        self._ahead = ahead

    def drift(self, time: float) -> None:
        """Move straight on; turn motions with relative motion by the midpoint rule, all others freely."""
        before, driven = self.pose.orientation, self._mechanisms.driven_motions
        middle, end = (self._start + self._time + part * time for part in (0.5, 1.0))
        followed = self._turned(before, middle, time)
        super().drift(time)
        orientation = np.where(driven[:, None], followed, self.pose.orientation)
        self.pose = Pose(self.pose.position, orientation)
        self._inertia = self._mechanisms.inertia(end)
        self._round = is_isotropic(self._inertia)
        self._inverse = np.asarray(np.linalg.inv(self._inertia), dtype=np.float64)

    def _turned(self, orientation: FloatArray, middle: float, time: float) -> FloatArray:
        """Orientation (N, q) after ``time`` with ω of the ``middle`` time at the orientation half-way."""
        way = time * self._rate(orientation, middle)
        for _ in range(_MOST_ITERATIONS):
            found = time * self._rate(rotate(orientation, 0.5 * way), middle)
            if np.abs(found - way).max() <= _ROUNDING * (1.0 + np.abs(way).max()):
                return rotate(orientation, found)
            way = found
        raise StepRejected(
            "mechanism", f"a rotation by {np.abs(way).max():.3g} rad in a step", "a fraction of a turn", "Shorten it."
        )

    def _rate(self, orientation: FloatArray, time: float) -> FloatArray:
        """Angular velocity ω = (R I Rᵀ)⁻¹ (L - R h), (N, k) [rad/time]."""
        left = self._momentum - turned(orientation, self._mechanisms.spin(time))
        inverse = inverse_lab_inertia(self._mechanisms.inertia(time), orientation)
        return np.asarray(np.einsum("nij,nj->ni", inverse, left))
