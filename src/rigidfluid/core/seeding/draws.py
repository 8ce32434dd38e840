"""Random numbers of a swarm, all from uniform ones, whose generator gives the same ones everywhere."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.scene.swarm_tables import LogNormalSizes, NormalSizes, SizeTable, TableSizes, UniformSizes


class Draws:
    """Random numbers of the swarm with a number in a scene with a ``seed``, or of what else has its own ``numbers``;
    each call goes on."""

    def __init__(self, seed: int, *numbers: int) -> None:
        self._generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *numbers])))

    def uniform(self, *shape: int) -> FloatArray:
        """Numbers from 0 to less than 1, of any shape [1]."""
        return self._generator.random(shape)

    def normal(self, *shape: int) -> FloatArray:
        """Numbers of mean 0 and standard deviation 1, of any shape [1]."""
        from scipy.special import ndtri

        return np.asarray(ndtri(1.0 - self.uniform(*shape)))  # never of zero

    def choices(self, count: int, weights: Sequence[float]) -> IntArray:
        """``count`` numbers of weights, each as often as its weight says, (count,)."""
        return _chosen(self.uniform(count), weights)

    def factors(self, count: int, table: SizeTable | None) -> FloatArray:
        """``count`` factors of lengths, (count,) [1]."""
        if table is None:
            return np.ones(count)
        return _quantile(self.uniform(count), table)

    def orientations(self, count: int, dimension: int) -> FloatArray:
        """``count`` orientations (count, q), all equally likely [rad | 1]: in 3D quaternions by K. Shoemake, Uniform
        random rotations, Graphics Gems III (1992) 124."""
        if dimension == 2:
            return 2.0 * np.pi * self.uniform(count, 1)
        part, *angles = self.uniform(3, count)
        first, second = (2.0 * np.pi * angle for angle in angles)
        near, far = np.sqrt(1.0 - part), np.sqrt(part)
        return np.stack(
            [far * np.cos(second), near * np.sin(first), near * np.cos(first), far * np.sin(second)], axis=1
        )

    def tilted(self, orientation: FloatArray, deviation: float) -> FloatArray:
        """``orientation`` (n, q) after a rotation about each axis with this standard deviation [rad | 1]."""
        count, spins = len(orientation), 1 if orientation.shape[1] == 1 else 3
        return rotate(orientation, deviation * self.normal(count, spins))


def share_between_ends(table: NormalSizes | LogNormalSizes) -> float:
    """Share of a distribution of sizes that its ends leave [1]."""
    from scipy.special import ndtr

    low, high = ndtr((_ends(table) - _centre(table)) / table.deviation)
    return float(high - low)


def _quantile(part: FloatArray, table: SizeTable) -> FloatArray:
    """Factors below which each ``part`` of all lies."""
    if isinstance(table, TableSizes):
        return np.array([size for size, _ in table.rows])[_chosen(part, [share for _, share in table.rows])]
    if isinstance(table, UniformSizes):
        return table.least + part * (table.greatest - table.least)
    drawn = _cut_normal(part, _centre(table), table.deviation, _ends(table))
    return np.exp(drawn) if isinstance(table, LogNormalSizes) else drawn


def _centre(table: NormalSizes | LogNormalSizes) -> float:
    """Mean of the normal distribution, of logarithms in a log-normal one."""
    return float(np.log(table.median)) if isinstance(table, LogNormalSizes) else table.mean


def _ends(table: NormalSizes | LogNormalSizes) -> FloatArray:
    """Both ends of the normal distribution, (2,)."""
    ends = np.array([table.least, table.greatest])
    return np.log(ends) if isinstance(table, LogNormalSizes) else ends


def _cut_normal(part: FloatArray, mean: float, deviation: float, ends: FloatArray) -> FloatArray:
    """Quantiles of a normal distribution between two ends."""
    from scipy.special import ndtr, ndtri

    low, high = ndtr((ends - mean) / deviation)
    return np.asarray(np.clip(mean + deviation * ndtri(low + part * (high - low)), *ends))


def _chosen(part: FloatArray, weights: Sequence[float]) -> IntArray:
    ends = np.cumsum(weights)
    found = np.searchsorted(ends, part * ends[-1], side="right")
    return np.asarray(np.minimum(found, np.flatnonzero(weights)[-1]), dtype=np.int64)
