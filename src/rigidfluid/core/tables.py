"""CSV tables that grow step by step and can be cut back to a checkpoint."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from rigidfluid.core.records import Row


class Table:
    """One CSV file, open for appending; numbers are written so that reading gives the same bits back.

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
        self._file = path.open("w" if length is None else "r+", newline="", encoding="utf-8")
        self._writer = csv.writer(self._file, lineterminator="\n")
        if length is None:
            self._writer.writerow(columns)
        else:
            self._file.truncate(length)
            self._file.seek(0, 2)

    def extend(self, rows: Sequence[Row]) -> None:
        """Append rows and hand them to the operating system."""
        self._writer.writerows(rows)
        self._file.flush()

    @property
    def length(self) -> int:
        """Bytes written so far."""
        return self._file.tell()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


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
