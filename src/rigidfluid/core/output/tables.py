"""CSV tables that grow step by step and can be cut back to a checkpoint."""

from __future__ import annotations

import csv
import os
from array import array
from collections.abc import Mapping, Sequence
from pathlib import Path
from sys import intern
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.output.records import Row
from rigidfluid.errors import OutputError


class Table:
    """CSV file that is opened for each append and never held, so that nothing is left open or unwritten.

    ``length`` None starts the file anew with the ``columns`` as header; otherwise what lies behind this many bytes is
    cut off.
    """

    def __init__(self, path: Path, columns: Sequence[str], length: int | None) -> None:
        self._path = path
        if length is None:
            self._write("w", [columns])
        else:
            self._cut(length)

    def extend(self, rows: Sequence[Row]) -> None:
        """Append rows; numbers are written so that reading gives the same bits back."""
        if rows:
            self._write("a", rows)

    @property
    def length(self) -> int:
        """Bytes written so far."""
        return self._path.stat().st_size

    def _cut(self, length: int) -> None:
        present = self.length if self._path.exists() else 0
        if present < length:
            found, allowed = f"{present} bytes", f"the {length} bytes or more of the checkpoint"
            raise OutputError(str(self._path), found, allowed, "Restore the file, or run without --resume.")
        os.truncate(self._path, length)

    def _write(self, mode: str, rows: Sequence[Sequence[object]]) -> None:
        with self._path.open(mode, newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


KINDS: Mapping[str, type[float | int | str]] = {
    **dict.fromkeys(("body", "a", "b", "joint"), str),
    **dict.fromkeys(("step", "probe", "unknowns", "remeshes", "cells"), int),
}
"""Types of the columns of names and whole numbers; all others hold numbers with a fraction."""


def table_path(folder: Path, name: str) -> Path:
    """The file of a table of a run."""
    return folder / f"{name}.csv"


def read_rows(path: Path, *, complete: bool = True) -> list[Row]:
    """Read the rows of a table on disk, numbers as numbers; raises ValueError where one is not. A last line that is cut
    off is dropped if the table need not be ``complete``."""
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(line for line in file if complete or line.endswith("\n"))
        names = next(reader, [])
        return [tuple(_value(name, text) for name, text in zip(names, row, strict=False)) for row in reader]


def read_header(path: Path) -> list[str]:
    """The columns' names."""
    with path.open(newline="", encoding="utf-8") as file:
        return next(csv.reader(file), [])


def read_columns(path: Path, wanted: Sequence[str]) -> dict[str, NDArray[Any]]:
    """Columns of a table on disk as arrays, with no more of it held meanwhile; raises ValueError as read_rows does."""
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        names = next(reader, [])
        columns = [(name, names.index(name), _empty(name)) for name in wanted]
        for row in reader:
            if len(row) < len(names):
                raise ValueError(f"a torn line {reader.line_num}")
            for name, place, values in columns:
                values.append(_value(name, row[place]))
        return {name: np.array(values) for name, _, values in columns}


def _empty(name: str) -> Any:
    """A column to append to, of eight bytes for each number."""
    kind = KINDS.get(name, float)
    return [] if kind is str else array("q" if kind is int else "d")


def _value(name: str, text: str) -> float | int | str:
    try:
        kind = KINDS.get(name, float)
        return intern(text) if kind is str else kind(text)
    except ValueError:
        raise ValueError(f"a value that is no number in column {name}") from None
