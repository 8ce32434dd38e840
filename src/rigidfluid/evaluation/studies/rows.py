"""Rows of a study, the settings and outcome of each run, and the CSV that holds them."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rigidfluid.core.output.writer import writing
from rigidfluid.errors import OutputError
from rigidfluid.evaluation.studies.model import Settings
from rigidfluid.evaluation.studies.subject import Outcome

_RESULTS = ("figure", "error", "seconds", "unknowns", "steps", "status", "message", "identity")
COMPLETE, FAILED = "complete", "failed"


@dataclass(frozen=True)
class Row:
    """One run: its ``outcome``, or the ``message`` of its failure."""

    outcome: Outcome | None
    message: str = ""

    @property
    def status(self) -> str:
        """ "complete" or "failed"."""
        return FAILED if self.outcome is None else COMPLETE


def fingerprint(identity: str) -> str:
    """A short text that stands for an identity."""
    return hashlib.sha256(identity.encode()).hexdigest()[:16]


def text_of(value: Any) -> str:
    """A knob's value as the CSV and the plot show it."""
    return value if isinstance(value, str) else json.dumps(value)


def short_text(value: Any, among: Sequence[Any]) -> str:
    """The same in few words: of a table only the keys that are not alike in all of the tables ``among``."""
    if not isinstance(value, Mapping):
        return text_of(value)
    differing = [key for key, part in value.items() if any(other.get(key) != part for other in among)]
    return ", ".join(f"{key} {text_of(value[key])}" for key in differing)


def cells(knobs: Sequence[str], settings: Settings) -> list[str]:
    """The values of the knobs; an empty text where a run does not read one."""
    return [text_of(settings[knob]) if knob in settings else "" for knob in knobs]


def write_rows(
    path: Path,
    knobs: Sequence[str],
    plan: Sequence[Settings],
    prints: Sequence[str],
    rows: Mapping[str, Row],
    errors: Mapping[str, float],
) -> None:
    """Write the rows there are, in the order of the plan; a kill at any time leaves the old file or the new one.

    ``plan`` holds the knobs that each planned run reads, ``prints`` its fingerprint; ``rows`` and ``errors`` are by
    fingerprint. Raises OutputError if the disk refuses.
    """
    fresh = path.with_suffix(".part")
    with writing(path), fresh.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*knobs, *_RESULTS])
        for settings, key in zip(plan, prints, strict=True):
            if key in rows:
                table.writerow([*cells(knobs, settings), *_results(rows[key], errors.get(key)), key])
    with writing(path):
        fresh.replace(path)


def _results(row: Row, error: float | None) -> list[object]:
    if row.outcome is None:
        return ["", "", "", "", "", row.status, row.message]
    outcome = row.outcome
    return [outcome.figure, error, outcome.seconds, outcome.unknowns, outcome.steps, row.status, ""]


def read_rows(path: Path) -> dict[str, Row]:
    """Rows of this study and of earlier versions, by fingerprint; none without the file. Raises OutputError."""
    if not path.exists():
        return {}
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return {line["identity"]: _row(line) for line in csv.DictReader(file)}
    except (OSError, KeyError, TypeError, ValueError) as error:
        found = f"{type(error).__name__}: {error}"
        raise OutputError(str(path), found, "the table of an earlier study", "Use --fresh to start anew.") from None


def _row(line: Mapping[str, str]) -> Row:
    if line["status"] == FAILED:
        return Row(None, line["message"])
    whole = (int(line[name]) for name in ("unknowns", "steps"))
    return Row(Outcome(float(line["figure"]), float(line["seconds"]), *whole))
