"""Wall time per stage of a run."""

from __future__ import annotations

import time
from typing import Self


class Stopwatch:
    """Adds up the seconds spent in each named stage; a stage within another counts by itself, and not in that one.

    ``with watch("detect"):`` times a stage. A step has a dozen, which generators would make noticeably slower.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._open: list[tuple[str, float, float]] = []
        self._within = 0.0

    def __call__(self, stage: str) -> Self:
        """Begin a stage, which ends with the block."""
        self._open.append((stage, time.perf_counter(), self._within))
        self._within = 0.0
        return self

    def __enter__(self) -> None:
        """Do nothing: the stage has begun."""

    def __exit__(self, *_: object) -> None:
        stage, start, outside = self._open.pop()
        taken = time.perf_counter() - start
        self.seconds[stage] = self.seconds.get(stage, 0.0) + taken - self._within
        self._within = outside + taken
