"""Common factor of prescribed values in time: a table, and a smooth rise from zero."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.core.nested.rows import Rows, read_rows
from rigidfluid.core.scene.scene import Scene, TimeFileTable, VaryingTable


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

