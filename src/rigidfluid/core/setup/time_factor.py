"""Common factor of prescribed values in time: a table, and a smooth rise from zero."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.core.scene.scene import Scene, TimeFileTable, VaryingTable
from rigidfluid.core.scene.validation import refuse_out_of_proportion
from rigidfluid.errors import SceneError

Rows = tuple[tuple[float, float], ...]

MOST_ROWS = 100_000
"""Greatest number of rows of a table: it is kept with the scene in every checkpoint."""


@dataclass(frozen=True)
class TimeFactor:
    """table(t) · s³(10 - 15 s + 6 s²) with s = t/ramp from 0 to 1, each 1 where it is not given [1].

    The ``table`` is linear between its rows (t, value); the rise has two continuous derivatives.
    """

    table: Rows | None = None
    ramp: float | None = None

    def __call__(self, time: float) -> float:
        """The factor at ``time``."""
        factor = 1.0
        if self.table is not None:
            factor *= float(np.interp(time, *self._columns))
        if self.ramp is not None:
            s = min(max(time / self.ramp, 0.0), 1.0)
            factor *= s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        return factor

    @cached_property
    def _columns(self) -> FloatArray:
        """Times and values of the table, (2, rows)."""
        return np.array(self.table).T


UNCHANGED = TimeFactor()
"""1 at all times."""


def check_rows(rows: Rows, end: float, at: str) -> None:
    """Refuse, with SceneError, rows whose times do not rise, or do not reach from 0 to the ``end`` [time]: nothing is
    extrapolated."""
    for number, (before, after) in enumerate(pairwise(rows), start=1):
        if not after[0] > before[0]:
            found = f"time {after[0]:g} after {before[0]:g}"
            raise SceneError(f"{at}.{number}", found, "times that rise", "Sort the rows, and leave out doubled times.")
    if not rows or rows[0][0] > 0.0 or rows[-1][0] < end:
        found = f"times from {rows[0][0]:g} to {rows[-1][0]:g}" if rows else "no rows"
        raise SceneError(at, found, f"times from 0 to time.end = {end:g}", "Add rows, or end the simulation earlier.")


def read_time_tables(scene: Scene) -> Scene:
    """A scene with the rows of all files of tables over time in their place, so that a checkpoint needs no file."""
    tables = list(scene.boundary)
    for number, given in _given_over_time(scene):
        if isinstance(given, TimeFileTable):
            rows = read_rows(given.file, f"boundary.{number}.over_time.file")
            tables[number] = tables[number].model_copy(update={"over_time": rows})
    return scene.model_copy(update={"boundary": tuple(tables)})


def rows_over_time(scene: Scene) -> dict[str, Rows]:
    """The tables over time of a scene, by their keys."""
    given = _given_over_time(scene)
    return {f"boundary.{number}.over_time": rows for number, rows in given if isinstance(rows, tuple)}


def _given_over_time(scene: Scene) -> Iterator[tuple[int, Rows | TimeFileTable | None]]:
    """Numbers of the conditions that may change in time, and what is given of it."""
    for number, table in enumerate(scene.boundary):
        if isinstance(table, VaryingTable):
            yield number, table.over_time


def read_rows(file: str, at: str) -> Rows:
    """Read a text file with a time and a value in each row, a comma between; lines that start with # are skipped.
    Raises SceneError if it cannot be read, is too long, or a row is not two finite numbers."""
    allowed, remedy = "a file of lines 'time, value'", "Correct it; start lines of words with #."
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")  # it is refused below
            rows = np.loadtxt(file, delimiter=",", ndmin=2, encoding="utf-8-sig")
    except (OSError, ValueError) as error:
        raise SceneError(at, f"{file!r}: {getattr(error, 'strerror', None) or error}", allowed, remedy) from None
    if not rows.size:
        raise SceneError(at, f"{file!r} without rows", allowed, remedy)
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise SceneError(at, f"{file!r} with {rows.shape[1]} columns, or infinite values", allowed, remedy)
    if len(rows) > MOST_ROWS:
        raise SceneError(at, f"{file!r} of {len(rows)} rows", f"at most {MOST_ROWS}", "Thin it out.")
    for number in rows.flat:
        refuse_out_of_proportion(at, float(number))
    return tuple(map(tuple, rows.tolist()))
