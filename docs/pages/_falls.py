"""A sphere that falls onto a floor and bounces: when and how fast it hits, and how high it rises."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from page_tools import Run


@dataclass(frozen=True)
class Fall:
    """Times (s,) [time], gaps under the sphere (s,) [length] and its velocities upwards (s,) [length/time]."""

    time: np.ndarray
    gap: np.ndarray
    velocity: np.ndarray

    @cached_property
    def impact(self) -> int:
        """The row of the first turn."""
        return int(np.argmax(self.velocity > 0.0))

    @cached_property
    def top(self) -> int:
        """The row of the greatest height after it."""
        return self.impact + int(np.argmax(self.gap[self.impact :]))

    @property
    def height(self) -> float:
        """Height of the rebound [length]."""
        return float(self.gap[self.top])

    @cached_property
    def turned(self) -> float:
        """Time of the impact, when the velocity changes its sign [time]."""
        rows = slice(self.impact - 1, self.impact + 1)
        return float(np.interp(0.0, self.velocity[rows], self.time[rows]))

    def speed_at(self, gap: float) -> float:
        """Speed downwards at a gap on the way in [length/time]."""
        way = slice(self.impact - 1, None, -1)
        return -float(np.interp(gap, self.gap[way], self.velocity[way]))


def read_fall(run: Run, radius: float) -> Fall:
    """Fall of the one sphere of a run, of this radius, along y."""
    bodies = run.history.bodies
    return Fall(bodies["time"], bodies["y"] - radius, bodies["vy"])
