"""Velocities and pressures prescribed on a piece of the boundary, and what is known of how they vary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np

from rigidfluid.core.fluid.conditions import Value
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.nested.rows import Rows

Profile = Callable[[FloatArray], FloatArray]
ALL_NAMES = frozenset({"x", "y", "z", "t"})


class NamedValue(Protocol):
    """A function of time and place, and the names of the coordinates that it depends on."""

    @property
    def names(self) -> frozenset[str]:
        """Coordinates that it uses, of x, y, z and t."""

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Values (N,) or (N, d) at ``points`` (N, d)."""


@dataclass(frozen=True)
class UnknownValue:
    """A function of which nothing is known: it may depend on all coordinates."""

    value: Value
    names: frozenset[str] = ALL_NAMES

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Values (N,) or (N, d) at ``points`` (N, d)."""
        return self.value(time, points)


@dataclass(frozen=True)
class TimeFactor:
    """table(t) · s³(10 - 15 s + 6 s²) with s = t/ramp from 0 to 1, each 1 where it is not given [1].

    The ``table`` is linear between its rows (t, value); the rise has two continuous derivatives.
    """

    table: Rows | None = None
    ramp: float | None = None

    def __call__(self, time: float) -> float:
        """The factor at ``time``."""
        factor = 1.0
        if self.table is not None:
            factor *= float(np.interp(time, *self._columns))
        if self.ramp is not None:
            s = min(max(time / self.ramp, 0.0), 1.0)
            factor *= s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        return factor

    @cached_property
    def _columns(self) -> FloatArray:
        """Times and values of the table, (2, rows)."""
        return np.array(self.table).T


UNCHANGED = TimeFactor()
"""1 at all times."""


@dataclass(frozen=True)
class BoundaryData:
    """Data prescribed on a surface: ``value(t, x)`` · factor(t)."""

    value: NamedValue
    factor: TimeFactor = field(default=UNCHANGED, kw_only=True)

    @property
    def is_steady(self) -> bool:
        """Tell whether it is the same at all times."""
        return self.factor == UNCHANGED and "t" not in self.value.names


@dataclass(frozen=True)
class BoundaryVelocity(BoundaryData):
    """Velocity prescribed on a surface: u(t, x) · profile(x) · factor(t), the ``profile`` 1 where it is None."""

    profile: Profile | None = None

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) [length/time]."""
        velocity = self.peak(time, points)
        return velocity if self.profile is None else self.profile(points)[:, None] * velocity

    def peak(self, time: float, points: FloatArray) -> FloatArray:
        """The velocity (N, d) where the profile is 1 [length/time]."""
        return self.value(time, points) * self.factor(time)

    @property
    def is_uniform(self) -> bool:
        """Tell whether it is the same everywhere on its surface."""
        return self.profile is None and not self.value.names & {"x", "y", "z"}


@dataclass(frozen=True)
class BoundaryPressure(BoundaryData):
    """Pressure prescribed on a surface: p(t, x) · factor(t) [force/length^(d-1)]."""

    def __call__(self, time: float, points: FloatArray) -> FloatArray:
        """Pressure (N,) at ``points`` (N, d)."""
        return self.value(time, points) * self.factor(time)


def boundary_velocity(value: Value) -> BoundaryVelocity:
    """The value of a condition as a velocity of which it is known how it varies, or else that nothing is."""
    return value if isinstance(value, BoundaryVelocity) else BoundaryVelocity(UnknownValue(value))
