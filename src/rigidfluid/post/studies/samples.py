"""Random samples of parameters."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field

from rigidfluid.post.studies.distributions import KEYS, Distribution
from rigidfluid.post.studies.sobol import block_length, sobol_points
from rigidfluid.post.studies.strict_table import Settings, StrictTable, flat


class RandomTable(StrictTable):
    """Parameters that are distributed, and how many samples are taken."""

    number: int = Field(ge=2, description="How many samples; a power of 2 with indices")
    seed: int = Field(default=0, ge=0, description="Seed of the random numbers")
    indices: bool = Field(default=False, description="Sobol indices, for which each sample is a block of runs")
    parameters: Annotated[dict[str, Distribution], BeforeValidator(lambda value: flat(value, KEYS))] = Field(
        min_length=1, description="Distributions, by dotted key of the scene"
    )

    @property
    def runs(self) -> int:
        """Count of the combinations of values."""
        return self.number * (block_length(len(self.parameters)) if self.indices else 1)


def draw_samples(random: RandomTable) -> list[Settings]:
    """Values of all parameters, sample by sample; more of the same seed begin with those of fewer."""
    count = len(random.parameters)
    if random.indices:
        points = sobol_points(random.number, count, random.seed)
    else:
        points = np.random.default_rng(random.seed).random((random.number, count))
    drawn = [each.quantile(points[:, place]).tolist() for place, each in enumerate(random.parameters.values())]
    return [dict(zip(random.parameters, row, strict=True)) for row in zip(*drawn, strict=True)]
