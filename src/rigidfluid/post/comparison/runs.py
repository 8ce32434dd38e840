"""The runs of a comparison: complete ones are kept, interrupted ones resumed, the rest started."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from os import SEEK_END
from pathlib import Path

from rigidfluid.core.model.ranks import ALONE
from rigidfluid.core.output.disk import replace_file, writing
from rigidfluid.core.output.result_file import require_result
from rigidfluid.core.output.tables import table_path
from rigidfluid.core.output.writer import earlier_run
from rigidfluid.core.scene.earlier import tables_now
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.scene_text import scene_text
from rigidfluid.errors import OutputError, RigidfluidError
from rigidfluid.post.comparison.child import run_apart
from rigidfluid.post.reports.results import Results, read_results

_TAIL = 4096
"""More bytes than a row of a table of energies has."""


@dataclass(frozen=True)
class Run:
    """One backend's run: its ``results``, or the ``error`` that it failed with; ``kept`` from an earlier comparison."""

    backend: str
    results: Results | None
    error: str = ""
    kept: bool = False


def backend_run(
    backend: str, scene: Scene, out: Path, *, fresh: bool = False, progress: Callable[[float], None] = lambda _: None
) -> Run:
    """Run the scene in ``<out>/<backend>``, unless its results are there already; an error is part of the result.

    The scene is written as ``<out>/<backend>.toml``; a ``fresh`` run neither keeps nor resumes an earlier one;
    ``progress`` is called with the fraction done. Raises OutputError if the disk refuses.
    """
    folder = out / backend
    if not fresh and (earlier := _earlier(scene, folder)) is not None:
        return Run(backend, earlier, kept=True)
    file, log = out / f"{backend}.toml", out / f"{backend}.log"
    with writing(file):
        file.parent.mkdir(parents=True, exist_ok=True)
        replace_file(file, (scene_text(scene.to_dict()) + "\n").encode())
    resume = not fresh and _can_resume(scene, folder)
    error = run_apart(file, folder, log, resume=resume, watch=lambda: progress(_time_reached(folder) / scene.time.end))
    return Run(backend, None, error) if error else _read(backend, folder)


def _read(backend: str, folder: Path) -> Run:
    try:
        return Run(backend, read_results(folder))
    except RigidfluidError as error:
        return Run(backend, None, str(error))


def _earlier(scene: Scene, folder: Path) -> Results | None:
    """Results of a whole run of the same scene."""
    try:
        results = read_results(folder)
    except RigidfluidError:
        return None
    same = results.summary.get("status") == "complete" and tables_now(results.summary["scene"]) == scene.to_dict()
    return results if same and results.present.all() else None


def _can_resume(scene: Scene, folder: Path) -> bool:
    """Tell whether there is a checkpoint of the same scene, and all of the tables up to it."""
    try:
        checkpoint = earlier_run(folder, ALONE)
    except OutputError:
        return False
    whole = all(table.begins(table_path(folder, name)) for name, table in checkpoint.tables.items())
    changed = any(json.loads(checkpoint.population).values())
    return whole and not changed and bool(tables_now(json.loads(checkpoint.scene)) == scene.to_dict())


def _time_reached(folder: Path) -> float:
    """Time in the last whole row of the table with one row a step; 0 before there is one."""
    path = table_path(folder, "energy")
    try:
        require_result(path)
        with path.open("rb") as table:
            table.seek(max(0, table.seek(0, SEEK_END) - _TAIL))
            rows = table.read().rpartition(b"\n")[0].splitlines()
    except (OSError, OutputError):
        return 0.0
    last = rows[-1].partition(b",")[0] if rows else b"time"
    return 0.0 if last == b"time" else float(last)
