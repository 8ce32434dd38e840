"""Structure factor: how much waves of each length are in the places of bodies."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples

WAVES = 12
"""Most waves along a side of the domain."""

_AT_ONCE = 256
"""Bodies whose waves are summed at once: in 3D 17 MB."""


class StructureFactor(NamedTuple):
    """S (w,) at ``wavenumber`` (w,) [1/length]."""

    wavenumber: FloatArray
    value: Mean


def structure_factor(samples: Samples) -> StructureFactor:
    """S(k) = |Σ exp(i k·x)|²/n, mean over waves of about one length, k = 2π (m₁/L₁, …) in the domain's box.

    It is not corrected for walls, which add to waves as long as the box.
    """
    sides = samples.upper - samples.lower
    every = product(range(-WAVES, WAVES + 1), repeat=samples.dimension)
    waves = 2.0 * np.pi * np.array([one for one in every if one > (0,) * samples.dimension]) / sides
    unit = 2.0 * np.pi / sides.max()
    band = np.rint(np.linalg.norm(waves, axis=1) / unit).astype(int)
    waves, band = waves[band <= WAVES], band[band <= WAVES]
    count = np.bincount(band)
    sums = samples.map_states(lambda position: np.bincount(band, _power(waves, position)), samples.position)
    kept = np.flatnonzero(count)
    return StructureFactor(unit * kept, mean(sums[:, kept] / count[kept]))


def _power(waves: FloatArray, position: FloatArray) -> FloatArray:
    """|Σ exp(i k·x)|²/n of each wave (w,)."""
    total = np.zeros(len(waves), dtype=complex)
    for first in range(0, len(position), _AT_ONCE):
        total += np.exp(1j * (waves @ position[first : first + _AT_ONCE].T)).sum(axis=1)
    return np.asarray(np.abs(total) ** 2 / len(position))
