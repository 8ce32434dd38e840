"""Diffusion of bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.post.statistics.samples import LEAST, Samples

LONGEST = 0.5
"""Longest lag over the time of all samples."""


class Diffusion(NamedTuple):
    """Mean square displacement (l, d) of bodies, without their common motion and a shear, after each ``lag`` (l,), not
    a number where no two bodies are there so long; and half its slope over the longer half of the others, D (d,), not a
    number with fewer than two [length², time, length²/time]."""

    lag: FloatArray
    displacement: FloatArray
    coefficient: FloatArray


def diffusion(samples: Samples) -> Diffusion:
    """Mean square displacement and D = slope/2; states must be at even times, as they nearly are.

    Over each lag the displacements are those of the bodies that are there at both of its ends, less their mean.
    """
    path, present = samples.own_path, samples.present
    lags = np.arange(1, max(2, int(LONGEST * len(path)) + 1))
    lags = lags[lags < len(path)]
    square = np.array([_square_displacement(path, present, lag) for lag in lags.tolist()])
    time = np.asarray(samples.interval * lags, dtype=float)
    return Diffusion(time, square, 0.5 * _late_slope(time, square))


def _square_displacement(path: FloatArray, present: BoolArray, lag: int) -> FloatArray:
    """Mean square displacement (d,) over so many states; not a number where no two bodies are there so long."""
    stays = (present[lag:] & present[:-lag])[..., None]
    count = np.count_nonzero(stays, axis=1, keepdims=True)
    stays = stays & (count >= LEAST)
    if not stays.any():
        return np.full(path.shape[2], np.nan)
    ends = path[:-lag], path[lag:]
    first, last = (place - place.sum(axis=1, where=stays, keepdims=True) / np.maximum(count, 1) for place in ends)
    return np.asarray(np.mean((last - first) ** 2, axis=(0, 1), where=stays))


def _late_slope(time: FloatArray, square: FloatArray) -> FloatArray:
    """Slope (d,) of what is known of ``square`` (l, d) in the longer half of the times (l,); not a number with fewer
    than two."""
    known = np.flatnonzero(np.isfinite(square[:, 0]))
    late = known[len(known) // 2 :]
    if len(late) < 2:
        return np.full(square.shape[1], np.nan)
    away = time[late] - time[late].mean()
    return np.asarray(away @ square[late] / (away @ away))
