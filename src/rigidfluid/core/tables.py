"""CSV tables that grow step by step and can be cut back to a checkpoint."""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from pathlib import Path

from rigidfluid.core.records import Row


class Table:
    """One CSV file; it is opened for each append and never held, so that nothing is left open or unwritten.

    Parameters
    ----------
    path : Path
        Where it is.
    columns : sequence of str
        The header.
    length : int or None
        None starts the file anew; otherwise what lies behind this many bytes is cut off.
    """

    def __init__(self, path: Path, columns: Sequence[str], length: int | None) -> None:
        self._path = path
        if length is None:
            self._write("w", [columns])
        else:
            os.truncate(path, length)

    def extend(self, rows: Sequence[Row]) -> None:
        """Append rows; numbers are written so that reading gives the same bits back."""
        if rows:
            self._write("a", rows)

    @property
    def length(self) -> int:
        """Bytes written so far."""
        return self._path.stat().st_size

    def _write(self, mode: str, rows: Sequence[Sequence[object]]) -> None:
        with self._path.open(mode, newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


def read_rows(path: Path) -> list[Row]:
    """The rows of a table on disk, numbers as numbers."""
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        next(reader, None)
        return [tuple(_value(text) for text in row) for row in reader]


def _value(text: str) -> float | int | str:
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            continue
    return text
