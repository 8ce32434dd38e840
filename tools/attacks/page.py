"""The page of all attacks, from what is kept of them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from datetime import date
from operator import itemgetter
from pathlib import Path
from typing import Any

from attacks.trials import KEPT

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "attack.md"

MEANINGS = {
    "scenes": """
Scenes that the JSON Schema allows, shipped ones with tables from there or with one to three changes, and scene files
with damaged text. Each is read and checked as by `rigidfluid check`, and a scene without a fluid takes its first steps.
It holds if this ends normally, or if an error of rigidfluid refuses it and names the field, or what the scene itself
names. Warnings count as errors.
""",
    "overrides": """
The same with shipped scenes and one or two settings, as after `--set`.
""",
    "parts": """
Parts of which one answer is not what it should be: of another type or shape, not finite, negative where it cannot be,
an exception, an exit, found twice or not at all, forces that are no slope of their energy. Each is met by a run in
substeps, by one in implicit steps where it is a law or a detector, by a check, or by a run in a fluid. It holds if an
error of rigidfluid names the part.
""",
    "geometry": """
Files of geometry, and a table over time, with damage to their bytes, and other things in their place. A scene with
such a file is read, checked and started. It holds if this ends normally, or if an error names the key or the file.
""",
    "checkpoints": """
Folders of runs in which the checkpoint, the tables or other files are damaged, edited or exchanged, taken up with
`--resume`. It holds if the run is refused by the name of a file in its folder, or ends with the tables of the
unbroken run to the last bit. Edits that renew the digest of a checkpoint too leave there what no run writes; nothing
could tell others.
""",
    "kills": """
Runs with checkpoints, which a signal ends at a random moment, five times each, taken up in between and at last left
alone. A kill holds if the command ends without a traceback, by the signal or with exit code 130, and the tables of
the last one are those of the unbroken run to the last bit. Where the end came first, the run begins again.
""",
}
"""What is done, and when it holds."""

TITLES = {
    "scenes": "Hostile scenes",
    "overrides": "Hostile settings",
    "parts": "Parts that lie",
    "geometry": "Damaged files of geometry",
    "checkpoints": "Damaged checkpoints and tables",
    "kills": "Kills",
    "soak": "Long runs",
}


def write_attack_page(kept: Path = KEPT, page: Path = PAGE) -> Path:
    """Write the page from the records of all kinds of attack; returns its file."""
    records = {kind: json.loads((kept / f"{kind}.json").read_text(encoding="utf-8")) for kind in TITLES}
    page.write_text("\n\n".join(_parts(records)) + "\n", encoding="utf-8")
    return page


def _parts(records: dict[str, Any]) -> Iterable[str]:
    yield "# Attacks"
    yield (
        f"Made on {date.today()} by `python tools/attack.py page` from what the commands below have kept. Each attempt "
        "is a process of its own, with limits of time and memory; one that hangs, is killed by a signal or ends in an "
        "error that is not rigidfluid's does not hold."
    )
    yield _table(("attack", "tried", "held", "command", "date", "commit", "CPU time"), map(_summary, records.items()))
    for kind, meaning in MEANINGS.items():
        yield f"## {TITLES[kind]}"
        yield meaning.strip()
        yield _table(
            ("", "tried", "held", "how it ended"), map(_group, sorted(records[kind]["groups"], key=itemgetter("group")))
        )
        yield from _failures(records[kind]["failures"])
    yield f"## {TITLES['soak']}"
    yield from _soak(records["soak"])


def _summary(entry: tuple[str, dict[str, Any]]) -> tuple[str, ...]:
    kind, record = entry
    groups = record.get("groups") or [{"tried": 1, "held": int(run["held"])} for run in record["runs"]]
    counts = (f"{sum(group[key] for group in groups):,}" for key in ("tried", "held"))
    made = (f"`{record['command']}`", record["date"], record["commit"], f"{record['cpu_seconds'] / 60:.0f} min")
    return (TITLES[kind], *counts, *made)


def _group(group: dict[str, Any]) -> tuple[str, ...]:
    endings = "; ".join(f"{how}: {count}" for how, count in group["endings"].items())
    return group["group"], str(group["tried"]), str(group["held"]), endings


def _failures(failures: list[dict[str, Any]]) -> Iterable[str]:
    if failures:
        yield "What did not hold:"
        yield _table(
            ("", "what was done", "how it ended"),
            ((one["group"], _cell(one["what"]), _cell(f"{one['how']}: {one['said']}")) for one in failures),
        )


def _soak(record: dict[str, Any]) -> Iterable[str]:
    most = ", ".join(f"{key} {factor:g}" for key, factor in record["most"].items())
    yield (
        "A dry run and one in a fluid, each in one process that writes its results. They hold if the median of each "
        f"figure in the last quarter is at most so many times that in the second one: {most}."
    )
    for run in record["runs"]:
        growth = ", ".join(f"{key} {value:.3f}" for key, value in run["growth"].items())
        settings = " ".join(f"--set '{setting}'" for setting in run["settings"])
        yield f"{run['run'].capitalize()}, `rigidfluid run scenes/{run['scene']} {settings}`; growth: {growth}."
        shown = run["samples"][3::4]
        yield _table(
            ("steps", "memory [MiB]", "open files", "CPU time of a step [ms]"),
            ((f"{s['steps']:,}", f"{s['memory']:.0f}", str(s["files"]), f"{s['cost']:.2f}") for s in shown),
        )


def _cell(text: str) -> str:
    """A text that fits into a cell of a table."""
    return "`" + text[:300].replace("|", "\\|").replace("`", "'").replace("\n", " ") + "`"


def _table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    head = tuple(head)
    return "\n".join("| " + " | ".join(line) + " |" for line in (head, ("---",) * len(head), *rows))
