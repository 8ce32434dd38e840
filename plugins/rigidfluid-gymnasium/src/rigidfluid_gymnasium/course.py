"""Values that actions set, as functions of time without jumps."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np

from rigidfluid.api import FloatArray

Row = tuple[float, FloatArray]


class Course:
    """Values (m,) over time: q₀ + (q₁ - q₀) s²(3 - 2s) from one row (t₀, q₀) to the next (t₁, q₁), where
    s = (t - t₀)/(t₁ - t₀).

    Before the first row and after the last one they rest. ``rows`` are replaced as a whole, so who keeps them can go
    back to them.
    """

    def __init__(self, start: FloatArray) -> None:
        self.rows: tuple[Row, ...] = ((0.0, start),)

    def turn(self, now: float, target: FloatArray, over: float) -> None:
        """Go from the values ``now``, not before the last row, to a ``target`` (m,) ``over`` a time [time]."""
        self.rows = (*self.rows, (now, self.value(now)), (now + over, target))

    def value(self, time: float) -> FloatArray:
        """Values (m,) at a ``time``."""
        (begun, before), (ended, after) = self._around(time)
        s = _share(time, begun, ended)
        return np.asarray(before + (after - before) * s**2 * (3.0 - 2.0 * s))

    def rate(self, time: float) -> FloatArray:
        """Rates (m,) of the values at a ``time`` [1/time]."""
        (begun, before), (ended, after) = self._around(time)
        s = _share(time, begun, ended)
        return np.asarray(6.0 * s * (1.0 - s) * (after - before) / ((ended - begun) or 1.0))

    def _around(self, time: float) -> tuple[Row, Row]:
        """Last row until a ``time`` and the first one after it; the same one twice at both ends."""
        after = bisect_right(self.rows, time, key=lambda row: row[0])
        last = len(self.rows) - 1
        return self.rows[max(after - 1, 0)], self.rows[min(after, last)]


class CourseDrive:
    """A course of one value as the drive of a joint."""

    def __init__(self, course: Course) -> None:
        self._course = course
        self.period: float | None = None

    def value(self, time: float) -> float:
        """Value of the coordinate [length | rad]."""
        return float(self._course.value(time)[0])

    def rate(self, time: float) -> float:
        """Rate of the value [length/time | rad/time]."""
        return float(self._course.rate(time)[0])

    def next_corner(self, time: float) -> float:
        """Infinite: its rate never jumps [time]."""
        return np.inf


def _share(time: float, begun: float, ended: float) -> float:
    return min(max((time - begun) / (ended - begun), 0.0), 1.0) if ended > begun else 0.0
