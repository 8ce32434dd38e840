"""Runs of a comparison, pairwise differences, and their JSON."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

from rigidfluid.post.comparison.differences import UNITS, Difference, Pair
from rigidfluid.post.comparison.runs import Run

COUNTS = ("steps", "rejected_steps", "remeshes", "cells", "unknowns")
"""Keys of the summaries that are set side by side, besides those of time and memory."""


@dataclass(frozen=True)
class Comparison:
    """The ``runs``, and a pair of the first that is complete with each other one; ``command`` makes it again."""

    command: str
    runs: tuple[Run, ...]
    pairs: tuple[Pair, ...]

    @property
    def complete(self) -> list[Run]:
        """The runs that did not fail."""
        return [run for run in self.runs if run.results is not None]

    @property
    def failed(self) -> list[Run]:
        """The runs that failed."""
        return [run for run in self.runs if run.results is None]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies, where a run is complete."""
        return next((run.results.names for run in self.runs if run.results is not None), ())

    def to_dict(self) -> dict[str, Any]:
        """The content of comparison.json."""
        return {
            "command": self.command,
            "runs": [_run_entry(run) for run in self.runs],
            "pairs": [self._pair_entry(each) for each in self.pairs],
        }

    def place(self, pair: Pair, difference: Difference) -> tuple[float, str | None]:
        """Time [time] and body of the largest difference; no body where the quantity is that of all together."""
        time, body = difference.largest_at
        return float(pair.time[time]), None if difference.is_global else self.bodies[body]

    def _pair_entry(self, pair: Pair) -> dict[str, Any]:
        differences = {}
        for name, difference in pair.differences.items():
            time, body = self.place(pair, difference)
            differences[name] = {
                "unit": UNITS[name],
                "largest": _finite(difference.largest),
                "relative": _finite(difference.relative),
                "range": _finite(difference.range),
                "time": time,
                "body": body,
                "final": _finite(difference.final),
            }
        return {
            "reference": pair.reference,
            "backend": pair.other,
            "until": float(pair.time[-1]),
            "times": len(pair.time),
            "interpolated": int(pair.interpolated.sum()),
            "differences": differences,
        }


def seconds_per_step(summary: dict[str, Any]) -> float:
    """Wall time over accepted steps [s]."""
    return float(summary["wall_time"] / max(summary["steps"], 1))


def _finite(value: float | None) -> float | None:
    """The number, or None where there is none: JSON knows no infinity."""
    return value if value is not None and isfinite(value) else None


def _run_entry(run: Run) -> dict[str, Any]:
    if run.results is None:
        return {"backend": run.backend, "error": run.error}
    summary = run.results.summary
    return {
        "backend": run.backend,
        "kept": run.kept,
        **{key: summary[key] for key in ("time", *COUNTS, "wall_time")},
        "wall_time_per_step": seconds_per_step(summary),
        "wall_time_per_stage": summary["wall_time_per_stage"],
        "peak_memory": summary.get("peak_memory"),
        "versions": summary["versions"],
    }
