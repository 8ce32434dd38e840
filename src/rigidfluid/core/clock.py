"""Time as whole ticks, so that steps of different size meet again exactly and a resumed run repeats every bit."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Clock:
    """A step of level l is the nominal step halved l times; a tick is the step of the deepest level.

    ``step`` [time], ``levels``: how many halvings are allowed, ``end`` [time].
    """

    step: float
    levels: int
    end: float

    @classmethod
    def for_steps(cls, step: float, shortest: float, end: float) -> Clock:
        """The clock whose deepest level is not below ``shortest``."""
        return cls(step, max(0, math.floor(math.log2(step / shortest) + 1e-9)), end)

    @property
    def last_tick(self) -> int:
        """The tick nearest to the end."""
        return self.tick_at(self.end)

    def tick_at(self, time: float) -> int:
        """The tick nearest to a time."""
        return round(time / self.step * (1 << self.levels))

    def time(self, tick: int) -> float:
        """The time of a tick."""
        return self.step * (tick / (1 << self.levels))

    def ticks(self, level: int) -> int:
        """Length of a step of this level."""
        return 1 << (self.levels - level)

    def size(self, level: int) -> float:
        """Size of a step of this level [time]."""
        return self.step / (1 << level)

    def longest_level(self, tick: int, previous: int | None) -> int:
        """The longest step that may start at ``tick``: on its grid, not past the end, at most twice the last one."""
        level = 0 if previous is None else max(0, previous - 1)
        while level < self.levels and (tick % self.ticks(level) or tick + self.ticks(level) > self.last_tick):
            level += 1
        return level
