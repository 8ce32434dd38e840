"""A folder belongs to one run at a time, and a run touches nothing there that no run has written."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.output.run_folder import PICTURES
from rigidfluid.core.run.run import run as simulate
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import OutputError
from rigidfluid.post.reports import report

SCENE = dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.1, step=0.01)
HOLD = """
import fcntl, sys
file = open(sys.argv[1], "a")
fcntl.flock(file, fcntl.LOCK_EX)
print("held", flush=True)
sys.stdin.read()
"""


def contents(folder: Path) -> dict[Path, bytes]:
    return {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}


@pytest.mark.parametrize(
    "name", ["report/thesis.tex", "state_of_the_art.h5", "fields/mine.vtu", "report/mine.png", "notes.csv"]
)
def test_foreign_files_stay_through_two_runs(tmp_path: Path, name: str) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("years of work")
    for _ in range(2):
        rigidfluid.run(SCENE, tmp_path)
    assert (tmp_path / name).read_text() == "years of work"


@pytest.mark.parametrize("name", ["bodies.csv", "state.h5", "summary.json", "fields/000000.vtu", "report/gap.png"])
def test_a_file_that_would_be_replaced_in_a_folder_of_no_run(tmp_path: Path, name: str) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("years of work")
    before = contents(tmp_path)
    with pytest.raises(OutputError, match=rf"{name}: found a file of this name in a folder that is not a run's"):
        rigidfluid.run(SCENE, tmp_path)
    assert contents(tmp_path) == before


def test_a_run_removes_the_report_of_the_one_before(tmp_path: Path) -> None:
    rigidfluid.run(SCENE, tmp_path)
    report(tmp_path)
    assert {file.stem for file in (tmp_path / "report").iterdir()} <= set(PICTURES)
    rigidfluid.run(SCENE, tmp_path)
    assert not (tmp_path / "report.html").exists()
    assert not list((tmp_path / "report").iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="folders are not locked there")
@pytest.mark.parametrize("resume", [False, True])
def test_a_second_run_in_the_same_folder_is_refused(tmp_path: Path, resume: bool) -> None:
    rigidfluid.run(SCENE, tmp_path)
    before = contents(tmp_path)
    other = subprocess.Popen(
        [sys.executable, "-c", HOLD, tmp_path / "run.lock"], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    with other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(OutputError, match=r"found a run in progress, of process \d+; .* another --out"):
            rigidfluid.run(SCENE, tmp_path, resume=resume)
        assert contents(tmp_path) == before
    rigidfluid.run(SCENE, tmp_path, resume=resume)


def test_a_folder_is_free_when_its_run_has_ended_or_failed(tmp_path: Path) -> None:
    simulation = Simulation(SCENE, tmp_path, False)
    with pytest.raises(OutputError, match="a run in progress"):
        rigidfluid.run(SCENE, tmp_path)
    simulation.close()
    rigidfluid.run(SCENE, tmp_path)
    rigidfluid.run(SCENE, tmp_path)


def test_a_run_whose_folder_vanishes_says_so_and_gives_no_results_that_are_not_summed_up(tmp_path: Path) -> None:
    out, ends = tmp_path / "out", list[History]()
    with pytest.raises(OutputError, match=r"out.*a folder that can be written to"):
        simulate(SCENE, out, progress=lambda now: shutil.rmtree(out, ignore_errors=True), finished=ends.append)
    assert not ends
