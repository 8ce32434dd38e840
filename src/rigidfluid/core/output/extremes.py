"""Extreme values of a run, kept as it goes, since no run holds its whole past."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Twist


@dataclass(frozen=True, slots=True)
class Extremes:
    """Extremes until now: ``smallest_gap`` [length], and the ``highest_speed`` of each body (n,) [length/time]."""

    smallest_gap: float
    highest_speed: FloatArray

    @classmethod
    def none(cls, bodies: int) -> Extremes:
        """Extremes of no state at all."""
        return cls(np.inf, np.zeros(bodies))

    def among(self, kept: IntArray, places: IntArray, bodies: int) -> Extremes:
        """Extremes among so many ``bodies``; those of the ``kept`` rows here are in these ``places`` (m,)."""
        speed = np.zeros(bodies)
        speed[places] = self.highest_speed[kept]
        return Extremes(self.smallest_gap, speed)

    def after(self, gaps: FloatArray, twist: Twist) -> Extremes:
        """Extremes with one more state in them, with each body's nearest gap (n,) [length]."""
        speed = np.sqrt(np.square(twist.velocity).sum(axis=1))
        return Extremes(min(self.smallest_gap, float(gaps.min(initial=np.inf))), np.maximum(self.highest_speed, speed))
