"""A scene's tables of strokes become functions of time."""

from __future__ import annotations

from rigidfluid.core.mechanics.strokes import Stroke
from rigidfluid.core.nested.rows import Rows, check_rows, read_rows
from rigidfluid.core.scene.rows_over_time import StrokeTable, TimeFileTable
from rigidfluid.errors import SceneError

_ROUNDING = 1e-9


def build_stroke(table: StrokeTable, at: str) -> Stroke:
    """Function of time that the table at the key ``at`` describes, repeated unless the table says no.

    Raises SceneError unless rows rise in time from 0, and for a period that is too short or ends with a jump.
    """
    key = _key(table, at)
    rows: Rows = getattr(read_stroke_rows(table, at), key)
    if len(rows) < 2:
        raise SceneError(f"{at}.{key}", f"{len(rows)} rows", "two rows or more", "Add rows of [time, value].")
    if rows[0][0] != 0.0:
        raise SceneError(f"{at}.{key}.0", f"time {rows[0][0]:g}", "time 0", "Begin with a row at time 0.")
    check_rows(rows, 0.0, f"{at}.{key}")
    return Stroke(rows, key == "smooth", _period(table, rows, f"{at}.{key}", at))


def read_stroke_rows(table: StrokeTable, at: str) -> StrokeTable:
    """A table with the rows of its file in the place of that, so that a checkpoint needs no file; raises SceneError
    where it cannot be read."""
    key = _key(table, at)
    given = getattr(table, key)
    if not isinstance(given, TimeFileTable):
        return table
    return table.model_copy(update={key: read_rows(given.file, f"{at}.{key}.file")})


def _key(table: StrokeTable, at: str) -> str:
    given = [key for key in ("piecewise", "smooth") if getattr(table, key) is not None]
    if len(given) != 1:
        found = "both piecewise and smooth" if given else "neither piecewise nor smooth"
        raise SceneError(at, found, "one of them", "Give its rows in one of them: [[time, value], …].")
    return given[0]


def _period(table: StrokeTable, rows: Rows, place: str, at: str) -> float | None:
    first, (end, last) = rows[0][1], rows[-1]
    if not table.repeat:
        if table.period is not None:
            raise SceneError(f"{at}.period", table.period, "none with repeat = false", "Leave out one of them.")
        return None
    period = end if table.period is None else table.period
    if period < end:
        raise SceneError(f"{at}.period", period, f"at least {end:g}, the time of the last row", "Lengthen it.")
    if abs(last - first) > _ROUNDING * max(abs(value) for _, value in rows):
        raise SceneError(
            f"{place}.{len(rows) - 1}",
            f"value {last:g} at the period's end, a jump back to {first:g}",
            f"{first:g}, the first row's value",
            "End where it begins, or say `repeat = false`.",
        )
    return period
