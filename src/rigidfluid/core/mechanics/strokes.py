"""Length or angle as a given function of time, once or periodic."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

_ROUNDING = 1e-11
"""Relative tolerance of a corner's time, over the stroke's duration: steps round their times."""

_SAME_SLOPE = 1e-9
"""Relative difference of slopes below which they make no corner."""


class Stroke:
    """Stroke s(t) through rows (time, value), repeated with a period or held after the last row.

    A piecewise stroke is linear between the rows, and its rate jumps at corners. A ``smooth`` one is the monotone cubic
    of Fritsch and Carlson (SIAM J. Numer. Anal. 17, 238, 1980), as scipy has it: between two rows it stays between
    their values, it rests at its extremes, and its rate has no jump; it need not stop at rows on its way, as a stroke
    of eased pieces would.

    ``rows`` have times that rise from 0 [time] and values [length | rad]. A ``period`` is not shorter than the rows,
    whose last value is then the first; the value rests between the last row and the period's end [time]. A stroke
    without one occurs once, and its last value is held.
    """

    def __init__(self, rows: Sequence[tuple[float, float]], smooth: bool = False, period: float | None = None) -> None:
        times, values = np.array(rows, dtype=float).T
        self.period, self.smooth = period, smooth
        self._span = float(times[-1] if period is None else period)
        rests = self._span > times[-1]
        self._times = np.append(times, self._span) if rests else times
        self._values = np.append(values, values[-1]) if rests else values

    def value(self, time: float) -> float:
        """Value s at a ``time`` [length | rad]."""
        phase = self._phase(time)
        return float(self._curve(phase) if self.smooth else np.interp(phase, self._times, self._values))

    def rate(self, time: float) -> float:
        """Rate ds/dt at a ``time``: at a corner that before it, as a step ends there; at time 0 that after it, as
        nothing is before [length/time | rad/time]."""
        if self.smooth:
            return float(self._slope(self._phase(time)))
        before = time - self._rounding if time > self._rounding else time
        return float(self._slopes[np.searchsorted(self._times, self._phase(before), side="right") - 1])

    def next_corner(self, time: float) -> float:
        """First time after this at which the rate jumps; infinite where it never does [time]."""
        after = time + self._rounding
        begun = 0.0 if self.period is None else self.period * math.floor(after / self.period)
        ahead = begun + self._corners[self._corners > after - begun]
        if self.period is not None:
            ahead = np.append(ahead, begun + self.period + self._corners[:1])
        return float(ahead[0]) if len(ahead) else math.inf

    def _phase(self, time: float) -> float:
        """Time since the present stroke began."""
        return min(max(time, 0.0), self._span) if self.period is None else time % self.period

    @property
    def _rounding(self) -> float:
        return _ROUNDING * self._span

    @cached_property
    def _slopes(self) -> FloatArray:
        """Slopes of the pieces, and zero from the last row on."""
        return np.append(np.diff(self._values) / np.diff(self._times), 0.0)

    @cached_property
    def _corners(self) -> FloatArray:
        """Times since the stroke began at which the rate jumps; a period's end is the next one's beginning."""
        if self.smooth:
            return np.zeros(0)
        slopes, times = self._slopes[:-1], self._times[:-1]
        before = np.roll(slopes, 1)
        if self.period is None:
            slopes, times, before = self._slopes[1:], self._times[1:], slopes
        return np.asarray(times[~np.isclose(slopes, before, rtol=_SAME_SLOPE, atol=0.0)])

    @cached_property
    def _curve(self) -> PchipInterpolator:
        """Monotone cubic through the rows and those around them: those of the periods before and after, or the held
        values."""
        from scipy.interpolate import PchipInterpolator  # slow to load, and few scenes have strokes

        times, values, span = self._times, self._values, self._span
        if self.period is None:
            around = [-span, *times, 2.0 * span], [values[0], *values, values[-1]]
        else:
            around = [*(times[:-1] - span), *times, *(times[1:] + span)], [*values[:-1], *values, *values[1:]]
        return PchipInterpolator(*around)

    @cached_property
    def _slope(self) -> PchipInterpolator:
        return self._curve.derivative()
