"""made.json beside kept results: by which commits and sources they were made, and in how much CPU time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from page_tools.provenance import commit, source_digest

RECORD = "made.json"
UNKNOWN = "unknown"
"""In place of a commit, of results that were made without these tools."""


@dataclass(frozen=True)
class Made:
    """The ``commits`` and the digests of ``sources`` that have made results, one after the other; CPU time [s]."""

    commits: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    cpu_seconds: float = 0.0

    @classmethod
    def read(cls, folder: Path) -> Made:
        """What is told of the results in a folder."""
        if not (folder / RECORD).exists():
            return cls((UNKNOWN,), (UNKNOWN,))
        told = json.loads((folder / RECORD).read_text(encoding="utf-8"))
        return cls.of(told) if "commits" in told else cls((UNKNOWN,), (UNKNOWN,))

    @classmethod
    def of(cls, told: Mapping[str, Any]) -> Made:
        """The same as JSON tells it."""
        return cls(tuple(told["commits"]), tuple(told["sources"]), told["cpu_seconds"])

    def write(self, folder: Path) -> None:
        """Write it beside results."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / RECORD).write_text(json.dumps(asdict(self)) + "\n", encoding="utf-8")

    def now(self, cpu_seconds: float) -> Made:
        """The same after these sources have worked on it, for some CPU time more [s]."""
        return Made(
            tuple(dict.fromkeys((*self.commits, commit()))),
            tuple(dict.fromkeys((*self.sources, source_digest()))),
            self.cpu_seconds + cpu_seconds,
        )

    @property
    def is_present(self) -> bool:
        """Whether the present sources alone have made it."""
        return self.sources == (source_digest(),)
