"""Wall and CPU time of a whole run."""

from __future__ import annotations

import time


class RunTimer:
    """Seconds since it was made, and those before a resumption that are added to them."""

    def __init__(self) -> None:
        self._wall_start, self._cpu_start = time.perf_counter(), time.process_time()
        self._wall_before = self._cpu_before = 0.0

    def add(self, elapsed: float, cpu_time: float) -> None:
        """Count the seconds of the run before its resumption, too."""
        self._wall_before, self._cpu_before = elapsed, cpu_time

    @property
    def elapsed(self) -> float:
        """Wall seconds."""
        return self._wall_before + time.perf_counter() - self._wall_start

    @property
    def cpu_time(self) -> float:
        """CPU seconds of this process, of all its threads."""
        return self._cpu_before + time.process_time() - self._cpu_start
