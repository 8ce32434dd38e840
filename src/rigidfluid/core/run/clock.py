"""Time as whole ticks, so that steps of different size meet again exactly and a resumed run repeats every bit."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigidfluid.errors import SceneError

_END_LEVEL = 3

_MOST_TICKS = 1 << 52
"""Ticks until the end that a number of 53 bits tells apart."""

_ROUNDING = 1e-6
"""Rounding of times, in ticks: a time so near to a tick is there."""


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
        """The clock whose deepest level is not below ``shortest``; raises SceneError where its ticks are too many to be
        told apart."""
        clock = cls(step, max(0, math.floor(math.log2(step / shortest) + 1e-9)), end)
        if clock.last_tick > _MOST_TICKS:
            allowed = f"at least {end / _MOST_TICKS:.2g}, a part of {_MOST_TICKS:g} of time.end"
            raise SceneError("time.shortest", f"{shortest:g}", allowed, "Allow no shorter steps.")
        return clock

    @property
    def last_tick(self) -> int:
        """The first eighth of a nominal step that is not before the end, so that no sliver of a step is left over."""
        coarse = max(0, self.levels - _END_LEVEL)
        return -(-self.tick_from(self.end) >> coarse) << coarse

    def tick_from(self, time: float) -> int:
        """The first tick that is not before a time."""
        return math.ceil(time / self.step * (1 << self.levels) - _ROUNDING)

    def tick_until(self, time: float) -> int:
        """The last tick that is not after a time."""
        return math.floor(time / self.step * (1 << self.levels) + _ROUNDING)

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
