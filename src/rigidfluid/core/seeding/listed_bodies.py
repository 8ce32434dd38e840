"""Bodies of a swarm that are listed in a CSV file."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from rigidfluid.core.scene.swarm_tables import MOST_BODIES
from rigidfluid.core.scene.validation import refuse_out_of_proportion, unknown_key, value_text
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_TEXT, require_regular

Row = Mapping[str, float | str]

_PLACES = {2: ("x", "y"), 3: ("x", "y", "z")}
_TURNS = {2: ("angle",), 3: ("qw", "qx", "qy", "qz")}
_VELOCITIES = {2: ("vx", "vy"), 3: ("vx", "vy", "vz")}
_SPINS = {2: ("w",), 3: ("wx", "wy", "wz")}
_ALONE = ("shape", "size", "radius", "density")
_NAME = "name"


def columns(dimension: int) -> tuple[tuple[str, ...], ...]:
    """Columns that belong together: place, orientation, velocity and angular velocity."""
    return tuple(group[dimension] for group in (_PLACES, _TURNS, _VELOCITIES, _SPINS))


def listed_bodies(file: str, at: str, dimension: int) -> list[Row]:
    """Rows of a CSV file by its columns, each with the number of its ``line``; lines that are empty or start with # are
    skipped. Raises SceneError, which names the line, for a file or a row that cannot be read."""
    require_regular(Path(file), at, MOST_TEXT)
    try:
        with Path(file).open(encoding="utf-8-sig", newline="") as lines:
            rows = list(_cells(csv.reader(lines)))
    except (OSError, ValueError, csv.Error) as error:
        remedy = "Save it as CSV with commas, in UTF-8."
        raise SceneError(at, f"{file!r}, which cannot be read ({type(error).__name__})", "a CSV file", remedy) from None
    if len(rows) < 2:
        raise SceneError(at, f"{file!r} without bodies", "a row of columns and one for each body", "Add them.")
    if len(rows) > MOST_BODIES + 1:
        raise SceneError(at, f"{file!r} with {len(rows) - 1} bodies", f"at most {MOST_BODIES}", "Use several swarms.")
    _check_header(rows[0][1], f"{at}, line {rows[0][0]}", dimension)
    return [{"line": line, **_row(rows[0][1], cells, f"{at}, line {line}")} for line, cells in rows[1:]]


def _cells(reader: Iterator[list[str]]) -> Iterator[tuple[int, list[str]]]:
    """Rows that are neither empty nor a comment, each with its line."""
    for line, cells in enumerate(reader, start=1):
        stripped = [cell.strip() for cell in cells]
        if any(stripped) and not stripped[0].startswith("#"):
            yield line, stripped


def _check_header(header: Sequence[str], at: str, dimension: int) -> None:
    groups = columns(dimension)
    known = [_NAME, *_ALONE, *(name for group in groups for name in group)]
    for name in header:
        if name not in known:
            raise unknown_key(f"{at}, column {name!r}", known, f"In {dimension}D these columns are read.")
    doubled = next((name for name in header if header.count(name) > 1), None)
    if doubled is not None:
        raise SceneError(at, f"column {doubled!r} twice", "each column once", "Remove one of them.")
    if {"size", "radius"} <= set(header):
        raise SceneError(at, "columns 'size' and 'radius'", "one of them", "Remove one of them.")
    for number, group in enumerate(groups):
        missing = [name for name in group if name not in header]
        if missing and (number == 0 or len(missing) < len(group)):
            allowed = f"the columns {', '.join(group)} together"
            raise SceneError(at, f"no column {missing[0]!r}", allowed, "Add it, also in the first row.")


def _row(header: Sequence[str], cells: Sequence[str], at: str) -> Row:
    if len(cells) != len(header):
        raise SceneError(at, f"{len(cells)} values", f"{len(header)}, as many as columns", "Complete or shorten it.")
    return {name: cell if name == _NAME else _number(name, cell, at) for name, cell in zip(header, cells, strict=True)}


def _number(name: str, cell: str, at: str) -> float:
    try:
        number = float(cell)
    except ValueError:
        number = math.nan
    positive = name in _ALONE and name != "shape"
    if not math.isfinite(number) or (positive and not number > 0.0):
        allowed = "a number above 0" if positive else "a number"
        raise SceneError(f"{at}, column {name!r}", value_text(cell), allowed, "Correct it.")
    refuse_out_of_proportion(f"{at}, column {name!r}", number)
    return number
