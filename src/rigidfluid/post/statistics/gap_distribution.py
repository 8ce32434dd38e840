"""Distribution of the gaps of bodies to their nearest surfaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples

SHARES = np.linspace(0.05, 0.95, 19)


class GapDistribution(NamedTuple):
    """Mean over the states of the ``gap`` (q,) that a ``share`` (q,) of the bodies is below [length, 1], not a number
    where it is that of a body with nothing near."""

    share: FloatArray
    gap: Mean


def gap_distribution(samples: Samples) -> GapDistribution:
    """Quantiles of the gaps; each is a gap of one of the bodies, as those without any are infinite."""
    gap = samples.map_states(lambda gaps: np.quantile(gaps, SHARES, method="inverted_cdf"), samples.gap)
    gap = np.asfortranarray(gap)  # sums are more exact along what is contiguous
    return GapDistribution(SHARES, mean(np.where(np.isfinite(gap), gap, np.nan)))
