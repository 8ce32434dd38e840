"""Diffusion of bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.samples import Samples

LONGEST = 0.5
"""Longest lag over the time of all samples."""


class Diffusion(NamedTuple):
    """Mean square displacement (l, d) of bodies, without their common motion and a shear, after each ``lag`` (l,), and
    half its slope over the longer half of the lags, D (d,) [length², time, length²/time]."""

    lag: FloatArray
    displacement: FloatArray
    coefficient: FloatArray


def diffusion(samples: Samples) -> Diffusion:
    """Mean square displacement and D = slope/2; states must be at even times, as they nearly are."""
    own = samples.own_path
    lags = np.arange(1, max(2, int(LONGEST * len(own)) + 1))
    lags = lags[lags < len(own)]
    square = np.array([((own[lag:] - own[:-lag]) ** 2).mean(axis=(0, 1)) for lag in lags])
    time = np.asarray(samples.interval * lags, dtype=float)
    late = slice(len(lags) // 2, None)
    away = time[late] - time[late].mean()
    slope = away @ square[late] / max(float(away @ away), np.finfo(float).tiny)
    return Diffusion(time, square, 0.5 * np.asarray(slope, dtype=float))
