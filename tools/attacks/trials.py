"""What was tried and what held, kept as a file of each kind of attack, and shown as a table."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

KEPT = Path(__file__).resolve().parents[2] / "out" / "attack"


@dataclass(frozen=True)
class Trial:
    """One attempt: the ``group`` that it is counted in, ``what`` was done, how it ended, and whether that ``held``."""

    group: str
    what: str
    how: str
    said: str
    held: bool


def row(group: str, trials: list[Trial]) -> dict[str, Any]:
    """Counts of one group: tried, held, and held by each ending."""
    held = [trial.how for trial in trials if trial.held]
    endings = {how: held.count(how) for how in sorted(set(held))}
    return {"group": group, "tried": len(trials), "held": len(held), "endings": endings}


def rows(trials: Iterable[Trial]) -> list[dict[str, Any]]:
    """Counts of all groups, in the order in which they came."""
    groups: dict[str, list[Trial]] = {}
    for trial in trials:
        groups.setdefault(trial.group, []).append(trial)
    return [row(group, members) for group, members in groups.items()]


def failures(trials: Iterable[Trial]) -> list[dict[str, Any]]:
    """What did not hold, in full."""
    return [asdict(trial) for trial in trials if not trial.held]


def keep(kind: str, record: dict[str, Any], folder: Path = KEPT) -> Path:
    """Write the record of one kind of attack; returns its file."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{kind}.json"
    file.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return file
