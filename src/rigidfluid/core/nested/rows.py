"""Rows of a time and a value: read from files, and checked."""

from __future__ import annotations

import re
import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np

from rigidfluid.core.scene.validation import refuse_out_of_proportion
from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_TEXT, require_regular

Rows = tuple[tuple[float, float], ...]

MOST_ROWS = 100_000
"""Greatest number of rows of a table: it is kept with the scene in every checkpoint."""


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


def read_rows(file: str, at: str) -> Rows:
    """Read a text file with a time and a value in each row, a comma between; lines that start with # are skipped.
    Raises SceneError if it cannot be read, is too long, or a row is not two finite numbers."""
    allowed, remedy = "a file of lines 'time, value'", "Correct it; start lines of words with #."
    require_regular(Path(file), at, MOST_TEXT)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "loadtxt: input contained no data")  # it is refused below
            with Path(file).open(encoding="utf-8-sig") as lines:
                rows = np.loadtxt(lines, delimiter=",", ndmin=2)
    except (OSError, ValueError) as error:  # its words may quote the file
        row = re.search(r"at row (\d+)", str(error))
        place = f"no numbers in row {int(row[1]) + 1}" if row else f"no rows of numbers ({type(error).__name__})"
        raise SceneError(at, f"{file!r} with {place}", allowed, remedy) from None
    if not rows.size:
        raise SceneError(at, f"{file!r} without rows", allowed, remedy)
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise SceneError(at, f"{file!r} with {rows.shape[1]} columns, or infinite values", allowed, remedy)
    if len(rows) > MOST_ROWS:
        raise SceneError(at, f"{file!r} of {len(rows)} rows", f"at most {MOST_ROWS}", "Thin it out.")
    for number in rows.flat:
        refuse_out_of_proportion(at, float(number))
    return tuple(map(tuple, rows.tolist()))
