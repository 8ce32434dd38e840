"""Tables over time of a scene: their rows, from files or from the scene itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidfluid.core.nested.rows import Rows, read_rows
from rigidfluid.core.scene.boundary_tables import BoundaryTable, VaryingTable
from rigidfluid.core.scene.rows_over_time import TimeFileTable


def read_time_tables(conditions: Sequence[BoundaryTable]) -> tuple[BoundaryTable, ...]:
    """Tables with the rows of all files of tables over time in their place, so that a checkpoint needs no file."""
    tables = list(conditions)
    for number, given in _given_over_time(conditions):
        if isinstance(given, TimeFileTable):
            rows = read_rows(given.file, f"boundary.{number}.over_time.file")
            tables[number] = tables[number].model_copy(update={"over_time": rows})
    return tuple(tables)


def rows_over_time(conditions: Sequence[BoundaryTable]) -> dict[str, Rows]:
    """The tables over time of conditions, by their keys."""
    given = _given_over_time(conditions)
    return {f"boundary.{number}.over_time": rows for number, rows in given if isinstance(rows, tuple)}


def _given_over_time(conditions: Sequence[BoundaryTable]) -> Iterator[tuple[int, Rows | TimeFileTable | None]]:
    """Numbers of the conditions that may change in time, and what is given of it."""
    for number, table in enumerate(conditions):
        if isinstance(table, VaryingTable):
            yield number, table.over_time
