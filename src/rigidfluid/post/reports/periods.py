"""Frequency of a quantity that oscillates steadily."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray

_LEAST_PERIODS = 3
_IRREGULAR = 0.1
"""Standard deviation of periods over their mean, from which on they are not periods of one swing."""
_GROWTH = 1.5
"""The first and the last third of a steady swing differ in amplitude by at most this factor."""


def late(time: FloatArray) -> FloatArray:
    """Tell whether a time (s,) is in the second half, where what started has most often settled."""
    return np.asarray(time >= 0.5 * (time[0] + time[-1]))


def late_periods(time: FloatArray, frequency: float) -> FloatArray:
    """Tell whether a time (s,) is in the whole periods that the second half of the time ends with."""
    count = np.floor(0.5 * (time[-1] - time[0]) * frequency)
    return np.asarray(time >= time[-1] - count / frequency)


def frequency(time: FloatArray, values: FloatArray, least: float) -> float | None:
    """Frequency of a steady swing (s,) in the second half of the rising ``time`` (s,), by upward crossings [1/time].

    None with fewer than three periods, if they scatter by a tenth, if the amplitude changes by half, or is below
    ``least``, in the units of ``values``.
    """
    chosen = late(time)
    when, swing = time[chosen], values[chosen]
    if len(when) < 2 * _LEAST_PERIODS or not np.isfinite(swing).all():
        return None
    swing = swing - np.trapezoid(swing, when) / np.ptp(when)
    rises = _rises(when, swing)
    lengths = np.diff(rises)
    if len(lengths) < _LEAST_PERIODS or lengths.std() > _IRREGULAR * lengths.mean():
        return None
    third = np.ptp(when) / 3.0
    first, last = (np.ptp(swing[part]) for part in (when <= when[0] + third, when >= when[-1] - third))
    if min(first, last) < 2.0 * least or max(first, last) > _GROWTH * min(first, last):
        return None
    return float(len(lengths) / (rises[-1] - rises[0]))


def _rises(time: FloatArray, values: FloatArray) -> FloatArray:
    """When values that are linear between the times rise through zero."""
    before = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    share = values[before] / (values[before] - values[before + 1])
    return np.asarray(time[before] + share * (time[before + 1] - time[before]))
