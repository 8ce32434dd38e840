"""The tables of a comparison, as texts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rigidfluid.post.comparison.comparison import COUNTS, Comparison, seconds_per_step
from rigidfluid.post.comparison.differences import UNITS, Pair, label

HEADER = ("quantity", "unit", "largest", "over its range", "at time", "of", "at the end")


def meaning(pair: Pair) -> str:
    """Sentence that says at which times two runs are compared, and at how many values are interpolated."""
    count, between = len(pair.time), int(pair.interpolated.sum())
    where = f"At the {count} times of {pair.reference} from {pair.time[0]:.5g} to {pair.time[-1]:.5g}"
    if not between:
        return f"{where}, all of which are steps of {pair.other} too."
    return f"{where}; at {between} of them {pair.other} has no step, and its values are interpolated linearly."


def difference_rows(comparison: Comparison, pair: Pair) -> Iterator[tuple[str, ...]]:
    """The cells below `HEADER`, a row for each quantity."""
    for name, difference in pair.differences.items():
        time, body = comparison.place(pair, difference)
        relative = "none" if difference.relative is None else f"{difference.relative:.3g}"
        largest, final = f"{difference.largest:.3g}", f"{difference.final:.3g}"
        yield label(name), UNITS[name], largest, relative, f"{time:.5g}", body or "all", final


def cost_rows(comparison: Comparison) -> Iterator[tuple[str, ...]]:
    """A name, and a cell for each run, empty where it failed."""
    yield "run", *("failed" if run.results is None else "kept" if run.kept else "complete" for run in comparison.runs)
    costs = [{} if run.results is None else _costs(run.results.summary) for run in comparison.runs]
    for name in dict.fromkeys(name for each in costs for name in each):
        values = [each.get(name) for each in costs]
        yield name, *("" if value is None else f"{value:.6g}" for value in values)


def _costs(summary: dict[str, Any]) -> dict[str, float | None]:
    memory = summary.get("peak_memory")
    return {
        "time reached [time]": summary["time"],
        **{key.replace("_", " "): summary[key] for key in COUNTS},
        "peak memory [MB]": memory and memory / 1e6,
        "wall time [s]": summary["wall_time"],
        "wall time per step [s]": seconds_per_step(summary),
        **{f"of it: {stage} [s]": seconds for stage, seconds in summary["wall_time_per_stage"].items()},
    }
