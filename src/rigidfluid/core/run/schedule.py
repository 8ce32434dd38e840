"""Decides when something is due in a run."""

from __future__ import annotations

import math

from rigidfluid.core.run.clock import Clock


class Schedule:
    """Due at the first accepted step at or after each multiple of ``every`` [time], and at the last step; None: at each
    step.

    ``latest``: when it was reached last [time].
    """

    def __init__(self, clock: Clock, every: float | None, latest: float = 0.0) -> None:
        self._clock, self._every, self.latest = clock, every, latest

    def due(self, tick: int) -> bool:
        """Tell whether it is due in the state at this ``tick``."""
        if self._every is None:
            return True
        number = math.floor(self.latest / self._every + 1e-9)
        return tick >= min(self._clock.tick_from((number + 1) * self._every), self._clock.last_tick)

    def reached(self, tick: int) -> None:
        """Record that it was reached in the state at this ``tick``."""
        self.latest = self._clock.time(tick)
