"""Tables of a run by state, checked as they are read: of the same bodies all the time, and of bodies that change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.system import System
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import Row, columns, columns_of, moving
from rigidfluid.core.output.summary_file import unreadable
from rigidfluid.core.output.tables import KINDS, read_header, read_rows, table_path

_STAMP = ("time", "step")
"""Columns that all rows of a state share."""


def table_by_state(folder: Path, name: str, system: System, count: int, *, complete: bool) -> dict[str, FloatArray]:
    """A table by column, each but the names (s, count): every row must be whole, and every state.

    A last row or state that is not whole is dropped, if the table need not be ``complete``; so are states of other
    bodies, which came or went after the checkpoint.
    """
    path, names = table_path(folder, name), columns_of(system)[name]
    rows = checked_rows(path, names, complete=complete)
    if name == "bodies" and not complete:
        rows = _rows_before_change(rows, names.index("step"), names.index("body"), moving(system))
    over = len(rows) % count
    if complete and over:
        raise unreadable(path, f"{len(rows)} rows, no multiple of the {count} that a state has")
    history = History(system.dimension, {name: rows[: len(rows) - over]}, columns_by_table={name: names})
    table = history.table(name).items()
    return {key: values.astype(np.float64).reshape(-1, count) for key, values in table if KINDS.get(key) is not str}


def nobody_by_state(dimension: int, states: int) -> dict[str, FloatArray]:
    """The table of bodies by column, (states, 0), of a run without any."""
    names = columns(dimension)["bodies"]
    return {name: np.zeros((states, 0)) for name in names if KINDS.get(name) is not str}


def _rows_before_change(rows: list[Row], step: int, body: int, order: Sequence[str]) -> list[Row]:
    """Rows of states before the first one that has another body than is next in the ``order``."""
    other = next((row[step] for i, row in enumerate(rows) if row[body] != order[i % len(order)]), None)
    return rows if other is None else list(takewhile(lambda row: row[step] != other, rows))


def changing_bodies(
    folder: Path, names: Mapping[str, tuple[str, ...]], known: Sequence[str], *, complete: bool
) -> tuple[tuple[str, ...], dict[str, FloatArray]]:
    """Names (n) of those among the ``known`` bodies that are in the table of bodies, and the table by column (s, n);
    ``names`` are those of the columns of each table.

    A body has no numbers at states in which it is not there, and an infinite gap. States without a row of energies and
    those from the first body on that is not known are dropped, if the table need not be ``complete``.
    """
    path = table_path(folder, "bodies")
    rows = _whole_states(folder, names, known, complete=complete)
    table = {name: np.array(values) for name, values in zip(names["bodies"], zip(*rows, strict=True), strict=True)}
    there = set(table["body"].tolist())
    numbered = tuple(name for name in known if name in there)
    return numbered, bodies_by_state(table, numbered, path)


def bodies_by_state(table: Mapping[str, NDArray[Any]], names: Sequence[str], path: Path) -> dict[str, FloatArray]:
    """The ``table`` of bodies of a ``path`` by column (s, n), of the bodies of these ``names`` (n); where one is not
    there it has no numbers, and an infinite gap. Raises OutputError for another body, and for two rows of one."""
    numbers = {name: number for number, name in enumerate(names)}
    there = set(table["body"].tolist())
    if there - numbers.keys():
        raise unreadable(path, f"a body {min(there - numbers.keys())!r} that has not entered")
    body = np.array([numbers[name] for name in table["body"].tolist()])
    _, first, state = np.unique(table["step"], return_index=True, return_inverse=True)
    if len(np.unique(state * len(numbers) + body)) < len(body):
        raise unreadable(path, "two rows of a body in a state")
    found = {}
    for name in (name for name in table if KINDS.get(name) is not str):
        found[name] = np.full((len(first), len(numbers)), np.inf if name == "gap" else np.nan)
        found[name][state, body] = table[name]
    shared = {name: np.repeat(table[name][first].astype(float)[:, None], len(numbers), axis=1) for name in _STAMP}
    return found | shared


def _whole_states(
    folder: Path, names: Mapping[str, tuple[str, ...]], known: Sequence[str], *, complete: bool
) -> list[Row]:
    rows = checked_rows(table_path(folder, "bodies"), names["bodies"], complete=complete)
    if complete:
        return rows
    step, body = names["bodies"].index("step"), names["bodies"].index("body")
    energy = checked_rows(table_path(folder, "energy"), names["energy"], complete=False)
    end = min((float(row[step]) for row in rows if row[body] not in known), default=np.inf)
    whole = {row[names["energy"].index("step")] for row in energy}
    return [row for row in rows if row[step] in whole and float(row[step]) < end]


def checked_rows(path: Path, names: Sequence[str], *, may_be_empty: bool = False, complete: bool = True) -> list[Row]:
    """All rows of a table of the columns ``names``; raises OutputError where one is torn, or the header is another."""
    try:
        header = read_header(path)
        rows = read_rows(path, complete=complete)
    except FileNotFoundError:
        raise unreadable(path, "no file") from None
    except OSError as error:
        raise unreadable(path, error.strerror) from error
    except UnicodeDecodeError as error:
        raise unreadable(path, f"no text ({error})") from error
    except ValueError as error:
        raise unreadable(path, str(error)) from error
    if tuple(header) != tuple(names):
        raise unreadable(path, f"the columns {', '.join(header) or 'of no header'}")
    torn = next((number for number, row in enumerate(rows, start=2) if len(row) != len(names)), None)
    if torn is not None or not (rows or may_be_empty):
        raise unreadable(path, "no rows" if torn is None else f"a torn line {torn}")
    return rows
