"""Document of a run in its folder: its summary, and its scene or model, also while it goes on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from rigidfluid.core.output.checkpoint import read_population, read_scene
from rigidfluid.core.output.summary_file import read_summary
from rigidfluid.core.output.writer import CHECKPOINT, SUMMARY
from rigidfluid.errors import OutputError


def read_document(folder: Path, needed: Iterable[str] = ("scene", "status")) -> tuple[dict[str, Any], dict[str, Any]]:
    """Summary with the ``needed`` keys, empty where the run has not ended, and the tables of its scene or model; raises
    OutputError where no run has written the ``folder``, or it cannot be read."""
    try:
        if (folder / SUMMARY).exists():
            summary = read_summary(folder / SUMMARY, needed)
            return summary, summary["scene"]
        if (folder / CHECKPOINT).exists():
            return {}, read_scene(folder / CHECKPOINT)
        found = f"neither {SUMMARY} nor {CHECKPOINT}" if folder.is_dir() else "no folder"
    except OSError as error:  # no folder can have that name, or it is closed to us
        found = error.strerror or str(error)
    remedy = "Give the one that the run wrote, its --out, or run the scene again."
    raise OutputError(str(folder), found, "the folder of a run", remedy)


def read_changes(folder: Path, summary: Mapping[str, Any]) -> Mapping[str, Any]:
    """The bodies that entered and left a run of this ``summary``, which is empty where it has not ended."""
    if not summary:
        return read_population(folder / CHECKPOINT)
    return dict(summary.get("population", {"entered": [], "gone": []}))
