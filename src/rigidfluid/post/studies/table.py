"""The CSV that holds a study's rows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from pathlib import Path

from rigidfluid.core.output.disk import replace_text, writing
from rigidfluid.core.output.result_file import require_result
from rigidfluid.errors import OutputError
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import FAILED, Row, cells
from rigidfluid.post.studies.subject import Outcome

_RESULTS = ("figure", "error", "seconds", "unknowns", "steps", "slope", "status", "message", "identity")


def write_rows(path: Path, results: Results) -> None:
    """Write the rows there are, in the order of the plan; a kill at any time leaves the old file or the new one.

    Raises OutputError if the disk refuses.
    """
    knobs = results.study.knobs
    lines = (
        [*cells(knobs, settings), *_results(results.rows[key], results.errors.get(key)), key]
        for settings, key in zip(results.plan, results.prints, strict=True)
        if key in results.rows
    )
    write_grid(path, ((*knobs, *_RESULTS), lines))


def write_grid(path: Path, grid: tuple[Iterable[str], Iterable[Iterable[object]]]) -> Path:
    """Write a header and rows; return the path. Raises OutputError if the disk refuses."""
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(grid[0])
    table.writerows(grid[1])
    with writing(path):
        replace_text(path, text.getvalue())
    return path


def _results(row: Row, error: float | None) -> list[object]:
    if row.outcome is None:
        return ["", "", "", "", "", "", row.status, row.message]
    outcome = row.outcome
    return [outcome.figure, error, outcome.seconds, outcome.unknowns, outcome.steps, outcome.slope, row.status, ""]


def read_rows(path: Path) -> dict[str, Row]:
    """Rows of this study and of earlier versions, by fingerprint; none without the file. Raises OutputError."""
    if not path.exists():
        return {}
    require_result(path)
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return {line["identity"]: _row(line) for line in csv.DictReader(file)}
    except (OSError, KeyError, TypeError, ValueError, csv.Error) as error:
        found = f"{type(error).__name__}: {error}"
        raise OutputError(str(path), found, "the table of an earlier study", "Use --fresh to start again.") from None


def _row(line: Mapping[str, str]) -> Row:
    if line["status"] == FAILED:
        return Row(None, line["message"])
    slope = line.get("slope")  # earlier versions have no such column
    figure, seconds = float(line["figure"]), float(line["seconds"])
    unknowns, steps = int(line["unknowns"]), int(line["steps"])
    return Row(Outcome(figure, seconds, unknowns, steps, float(slope) if slope else None))
