"""The record of a page: when, by which commit and versions it was made, its runs, and what its files are since."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from page_tools.first_steps import Steps
from page_tools.places import PAGES, RECORDS, ROOT
from page_tools.provenance import file_digest, source_digest, text_digest
from page_tools.settings import Settings


@dataclass(frozen=True)
class RunRecord:
    """A run: the ``command`` that makes it, by hand, or its ``tables``; by which ``commits`` it was made, its CPU time
    [s], and its first ``steps``."""

    command: str
    settings: Settings
    commits: tuple[str, ...]
    cpu_seconds: float
    steps: Steps


@dataclass(frozen=True)
class Record:
    """What is known of a page.

    ``sources`` are digests of what has made its runs, ``texts`` those of what its generators say, by path, and
    ``files`` those of the page and its figures; ``cpu_seconds`` is of the page and all runs, also of those that have
    no entry in ``runs``, as they are made by the page itself or by a study; None of pages older than their records.
    """

    made: str
    commit: str
    cpu_seconds: float | None
    versions: dict[str, str] = field(default_factory=dict)
    sources: tuple[str, ...] = ()
    texts: dict[str, str] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    runs: dict[str, RunRecord] = field(default_factory=dict)

    def write(self, name: str, folder: Path = RECORDS) -> None:
        """Write it beside the page, a run a line."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.json").write_text(_json_lines(asdict(self)), encoding="utf-8")

    def edited(self, pages: Path = PAGES) -> list[str]:
        """Files of the page that are not what was written."""
        return [file for file, known in self.files.items() if file_digest(pages / file) != known]

    def reworded(self) -> list[str]:
        """Modules of docs/pages that say something else since."""
        return [path for path, known in self.texts.items() if text_digest(ROOT / path) != known]

    @property
    def making(self) -> str:
        """By what it was made, and for how much CPU time."""
        cost = "in an unknown time" if self.cpu_seconds is None else f"in {self.cpu_seconds:.0f} s of CPU time"
        return f"made on {self.made} at {self.commit}, {cost}"

    @property
    def is_present(self) -> bool:
        """Whether it was made by what is here: the same sources alone, the same words, the same files."""
        return self.sources == (source_digest(),) and not self.reworded() and not self.edited()


def _json_lines(told: dict[str, Any]) -> str:
    runs = ",\n".join(f"  {json.dumps(label)}: {json.dumps(run)}" for label, run in told["runs"].items())
    rest = (f" {json.dumps(key)}: {json.dumps(value)}" for key, value in told.items() if key != "runs")
    return "{\n" + ",\n".join([*rest, f' "runs": {{\n{runs}\n }}']) + "\n}\n"


def read_record(name: str, folder: Path = RECORDS) -> Record | None:
    """The record of a page; None where there is none."""
    path = folder / f"{name}.json"
    if not path.exists():
        return None
    told = json.loads(path.read_text(encoding="utf-8"))
    runs = {label: _run(run) for label, run in told.pop("runs").items()}
    return Record(**told | {"runs": runs, "sources": tuple(told["sources"])})


def _run(told: dict[str, Any]) -> RunRecord:
    return RunRecord(**told | {"settings": Settings(**told["settings"]), "commits": tuple(told["commits"])})
