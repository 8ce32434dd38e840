"""Distributions of random parameters."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.studies.strict_table import StrictTable


class _Between(StrictTable):
    """A distribution between two ends."""

    low: float = Field(description="Least value")
    high: float = Field(description="Greatest value")

    @model_validator(mode="after")
    def _has_room(self) -> Self:
        if not self.low < self.high:
            raise ValueError("low below high")
        return self


class Uniform(_Between):
    """Equal chances for equal differences."""

    distribution: Literal["uniform"]

    def quantile(self, part: FloatArray) -> FloatArray:
        """Values below which each ``part`` of all lies."""
        return self.low + part * (self.high - self.low)


class LogUniform(_Between):
    """Equal chances for equal ratios."""

    distribution: Literal["log-uniform"]
    low: float = Field(gt=0.0, description="Least value")

    def quantile(self, part: FloatArray) -> FloatArray:
        """Values below which each ``part`` of all lies."""
        return self.low * (self.high / self.low) ** part


class Normal(StrictTable):
    """Gauss's distribution."""

    distribution: Literal["normal"]
    mean: float = Field(description="Mean value")
    deviation: float = Field(gt=0.0, description="Standard deviation")

    def quantile(self, part: FloatArray) -> FloatArray:
        """Values below which each ``part`` of all lies."""
        from scipy.special import ndtri

        return np.asarray(self.mean + self.deviation * ndtri(part))


Distribution = Annotated[Uniform | LogUniform | Normal, Field(discriminator="distribution")]

KEYS = frozenset(key for table in (Uniform, LogUniform, Normal) for key in table.model_fields)
"""Keys that tell a distribution from a table of scene keys."""
