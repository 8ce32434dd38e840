"""What each step of a kept run has cost."""

from __future__ import annotations

import csv
import time
from pathlib import Path
from typing import TextIO

from rigidfluid.core.run.run import Progress

PROGRESS = "progress.csv"
COLUMNS = ("time", "step", "wall_time", "cpu_seconds")


class CostTable:
    """progress.csv beside a run: after each step its time, its length, and the seconds since the run was started.

    Of a run that is ``resumed``, CPU time counts up to the checkpoint; of steps after it, which are made again, it is
    forgotten.
    """

    def __init__(self, folder: Path, resumed: bool) -> None:
        self._path = folder / PROGRESS
        self._rows = _rows(self._path) if resumed else []
        self._start = time.process_time()
        self._file: TextIO | None = None

    def add(self, now: Progress) -> None:
        """Write the row of a step."""
        if self._file is None:
            self._begin(now.time)
        before = self._rows[-1][-1] if self._rows else 0.0
        spent = before + time.process_time() - self._start
        print(now.time, now.step, now.elapsed, spent, sep=",", file=self._file)

    def close(self) -> None:
        """Write no more."""
        if self._file is not None:
            self._file.close()

    def _begin(self, first: float) -> None:
        self._rows = [row for row in self._rows if row[0] < first]
        self._file = self._path.open("w", buffering=1, encoding="utf-8")
        for row in (COLUMNS, *self._rows):
            print(*row, sep=",", file=self._file)


def _rows(path: Path) -> list[tuple[float, ...]]:
    """Those that are whole: a run that was killed may have left half of one."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [tuple(map(float, row)) for row in list(csv.reader(file))[1:] if len(row) == len(COLUMNS)]
