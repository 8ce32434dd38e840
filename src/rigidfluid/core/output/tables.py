"""CSV tables that grow step by step and can be cut back to a checkpoint."""

from __future__ import annotations

import csv
import io
import os
from array import array
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from sys import intern
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.output.disk import replace_file
from rigidfluid.core.output.records import Row
from rigidfluid.core.output.result_file import require_result
from rigidfluid.errors import OutputError

_CHUNK = 1 << 20
"""Bytes that are read at once."""


@dataclass(frozen=True, slots=True)
class Prefix:
    """The first ``length`` bytes of a file, with their CRC-32."""

    length: int = 0
    crc: int = 0

    def followed_by(self, data: bytes) -> Prefix:
        """The prefix that ends behind ``data``."""
        return Prefix(self.length + len(data), crc32(data, self.crc))

    def begins(self, path: Path) -> bool:
        """Tell whether a file begins so."""
        return not self._found(path)

    def require(self, path: Path) -> None:
        """Raise OutputError where a file does not begin so."""
        found = self._found(path)
        if found:
            allowed = f"the {self.length} bytes of the checkpoint, as they were written, or more behind them"
            raise OutputError(str(path), found, allowed, "Restore the file, or run without --resume.")

    def _found(self, path: Path) -> str:
        """Difference of a file from it in words, empty where there is none."""
        if not path.is_file():
            return "no regular file" if path.exists() else "no such file"
        with path.open("rb") as file:
            present = Prefix()
            while data := file.read(min(_CHUNK, self.length - present.length)):
                present = present.followed_by(data)
        if present.length < self.length:
            return f"{present.length} bytes"
        return "" if present == self else f"other content in its first {self.length} bytes"


class Table:
    """CSV file that is opened for each append and never held, so that nothing is left open or unwritten.

    ``kept`` None starts the file with the ``columns`` as header; otherwise what lies behind this prefix is cut off.
    """

    def __init__(self, path: Path, columns: Sequence[str], kept: Prefix | None) -> None:
        self._path = path
        self.written = Prefix() if kept is None else kept
        """Content so far."""
        if kept is None:
            replace_file(path, b"")
            self.extend([tuple(columns)])
        else:
            kept.require(path)
            _refuse_second_name(path)
            os.truncate(path, kept.length)

    def extend(self, rows: Sequence[Row]) -> None:
        """Append rows; numbers are written so that reading gives the same bits back. Raises OutputError where somebody
        else has written to the file."""
        if not rows:
            return
        text = io.StringIO(newline="")
        csv.writer(text, lineterminator="\n").writerows(rows)
        data = text.getvalue().encode()
        with self._path.open("r+b") as file:
            present = file.seek(0, os.SEEK_END)
            if present != self.written.length:
                found, allowed = f"{present} bytes", f"the {self.written.length} bytes that this run has written"
                raise OutputError(str(self._path), found, allowed, "Leave it alone during a run; then use --resume.")
            file.write(data)
        self.written = self.written.followed_by(data)


def _refuse_second_name(path: Path) -> None:
    """Raise OutputError where a file is reached by another name too, whose owner would lose what is written here."""
    names = path.stat().st_nlink
    if names > 1:
        remedy = "Put a copy in its place, or run without --resume."
        raise OutputError(str(path), f"a file with {names} names (hard links)", "a file with this name alone", remedy)


KINDS: Mapping[str, type[float | int | str]] = {
    **dict.fromkeys(("body", "a", "b", "joint", "surface", "wall", "change", "parameter"), str),
    **dict.fromkeys(("step", "probe", "unknowns", "remeshes", "cells", "bodies", "contacts"), int),
}
"""Types of the columns of names and whole numbers; all others hold numbers with a fraction."""


def table_path(folder: Path, name: str) -> Path:
    """The file of a table of a run."""
    return folder / f"{name}.csv"


def read_rows(path: Path, *, complete: bool = True) -> list[Row]:
    """Read the rows of a table on disk, numbers as numbers; raises ValueError where one is not. A last line that is cut
    off is dropped if the table need not be ``complete``."""
    with _reader(path, complete) as reader:
        names: list[str] = next(reader, [])
        return [tuple(_value(name, text) for name, text in zip(names, row, strict=False)) for row in reader]


def read_header(path: Path) -> list[str]:
    """The columns' names."""
    with _reader(path, complete=True) as reader:
        return next(reader, [])


def read_columns(path: Path, wanted: Sequence[str], *, complete: bool = True) -> dict[str, NDArray[Any]]:
    """Columns of a table on disk as arrays, with no more of it held meanwhile; raises ValueError as read_rows does, and
    drops a last line as it does."""
    with _reader(path, complete) as reader:
        names: list[str] = next(reader, [])
        columns = [(name, names.index(name), _empty(name)) for name in wanted]
        for row in reader:
            if len(row) < len(names):
                raise ValueError(f"a torn line {reader.line_num}")
            for name, place, values in columns:
                values.append(_value(name, row[place]))
        return {name: np.array(values) for name, _, values in columns}


@contextmanager
def _reader(path: Path, complete: bool) -> Iterator[Any]:
    """The lines of a table, split; raises ValueError where they are of no table."""
    require_result(path)
    with path.open(newline="", encoding="utf-8") as file:
        try:
            yield csv.reader(line for line in file if complete or line.endswith("\n"))
        except csv.Error as error:
            raise ValueError(str(error)) from None


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
