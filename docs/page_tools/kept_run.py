"""Runs that are kept in a folder: made once, gone on with where they were stopped, and then read."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import rigidfluid
from page_tools.cost_table import CostTable
from page_tools.made import Made
from rigidfluid.core.model.ranks import ALONE
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.output.history import History
from rigidfluid.core.output.writer import CHECKPOINT
from rigidfluid.core.run.run import Progress
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import OutputError, StepError


@dataclass(frozen=True)
class Run:
    """A run of a ``scene`` in a ``folder``."""

    scene: Scene
    folder: Path

    @property
    def history(self) -> History:
        """Its tables, read when they are asked for, with its summary."""
        history = History(self.scene.dimension, folder=self.folder)
        history.summary = self.summary
        return history

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Its summary.json."""
        return json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))

    @property
    def cpu_seconds(self) -> float:
        """CPU time of all threads, start included [s]; not a number where the run does not tell it."""
        return self.summary.get("cpu_time", math.nan)


def keep_run(scene: Scene, folder: Path, *, fresh: bool = False, may_stop: bool = False) -> Run:
    """Run a scene in a folder, unless it is complete there; go on where it was stopped.

    Parameters
    ----------
    scene : Scene
        What to run.
    folder : Path
        Where its results are kept; a run of another scene there is replaced.
    fresh : bool
        Whether to replace any run there.
    may_stop : bool
        Whether a step that fails leaves the run as far as it came, in place of a StepError.
    """
    found = "fresh" if fresh else _found(scene, folder)
    print(f"{folder.parent.name}/{folder.name}: {_SAID[found]}", flush=True)
    if found != "complete":
        try:
            _run(scene, folder, resume=found == "stopped")
        except StepError as error:
            if not may_stop:
                raise
            print(error, flush=True)
    return Run(scene, folder)


def is_complete(folder: Path) -> bool:
    """Whether a folder holds a run that reached its end."""
    summary = folder / "summary.json"
    return summary.exists() and json.loads(summary.read_text(encoding="utf-8"))["status"] == "complete"


_SAID = {
    "complete": "kept",
    "stopped": "goes on",
    "another": "runs anew, since what is there is of another scene",
    "unreadable": "runs anew, since it was stopped and its checkpoint cannot be read",
    "nothing": "runs",
    "fresh": "runs anew",
}


def _found(scene: Scene, folder: Path) -> str:
    """What there is in a folder for this scene."""
    if is_complete(folder):
        return "complete" if Run(scene, folder).summary["scene"] == scene.to_dict() else "another"
    if not (folder / CHECKPOINT).exists():
        return "another" if (folder / "summary.json").exists() else "nothing"
    try:
        kept = json.loads(read_checkpoint(folder / CHECKPOINT, ALONE).scene)
    except OutputError:
        return "unreadable"
    return "stopped" if kept == scene.to_dict() else "another"


def _run(scene: Scene, folder: Path, resume: bool) -> None:
    made, cost = (Made.read(folder) if resume else Made()).now(0.0), CostTable(folder, resume)
    began: list[bool] = []

    def observe(now: Progress) -> None:
        if not began:
            began.append(True)
            made.write(folder)
        cost.add(now)

    try:
        rigidfluid.run(scene, folder, resume=resume, progress=observe)
    finally:
        cost.close()
