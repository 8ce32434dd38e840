"""Studies with several runs at a time: the same rows as with one, whatever becomes of a process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from falling_study import falling_study
from typer.testing import CliRunner

from rigidfluid.cli import app
from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.post.progress import RunsProgress
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.processes import MOST_JOBS, run_apart
from rigidfluid.post.studies.rows import Row
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Outcome, Target
from rigidfluid.post.studies.table import read_rows
from rigidfluid.python_process import ONE_THREAD, environment, python

DENSITIES = "[parameters]\nbody.0.density = [1.0, -1.0, 2.0, 3.0]\n"
ANSWERS = ("answer", "refuse", "fault", "print", "kill")


@dataclass
class Trouble:
    """A subject that does what its settings say; figures are numbers of threads, seconds processes."""

    target: Target

    def read(self, settings: Settings) -> Settings:
        return settings

    def identity(self, settings: Settings) -> str:
        return str(settings)

    def run(self, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        if settings["do"] == "refuse":
            raise SceneError("field", "this", "that", "Mend it.")
        if settings["do"] == "fault":
            raise ZeroDivisionError("a fault of a part")
        if settings["do"] == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if settings["do"] == "sleep":
            time.sleep(1000.0)
        if settings["do"] == "print":
            os.write(1, b"words of a library\n")
        names = [name for name in os.environ if name.endswith("_NUM_THREADS")]
        return Outcome(max(float(os.environ[name]) for name in names), os.getpid(), 0, 0)


@pytest.fixture
def trouble(monkeypatch: pytest.MonkeyPatch) -> Trouble:
    """Known by its module's name in other processes too."""
    for name in ONE_THREAD:
        monkeypatch.setenv(name, "2")
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    import test_jobs

    return test_jobs.Trouble(Target("figure", None, "figure", "", relative=False))  # type: ignore[no-any-return]


def rows_of(trouble: Trouble, deeds: tuple[str, ...], jobs: int) -> dict[str, Row]:
    return dict(run_apart(trouble, {f"{number} {deed}": {"do": deed} for number, deed in enumerate(deeds)}, jobs))


def test_rows_are_those_of_one_process(tmp_path: Path) -> None:
    study = load_study(falling_study(tmp_path, DENSITIES))
    one, _ = run_study(study, tmp_path / "one")
    two, _ = run_study(study, tmp_path / "two", jobs=2)
    assert set(two.rows) == set(one.rows)
    for key, row in one.rows.items():
        assert two.rows[key].message == row.message
        assert (two.rows[key].outcome is None) == (row.outcome is None)
        if row.outcome is not None and (other := two.rows[key].outcome) is not None:
            assert (other.figure, other.unknowns, other.steps) == (row.outcome.figure, 0, row.outcome.steps)
            assert other.seconds > 0.0
    assert sum(row.outcome is None for row in two.rows.values()) == 1
    assert read_rows(tmp_path / "two" / "study.csv") == two.rows


@pytest.mark.long
def test_only_what_is_missing_is_run_and_progress_counts_all(tmp_path: Path) -> None:
    fewer = load_study(falling_study(tmp_path, DENSITIES.replace(", 3.0", "")))
    first, _ = run_study(fewer, tmp_path / "out", jobs=2)
    seen: list[RunsProgress] = []
    second, _ = run_study(
        load_study(falling_study(tmp_path, DENSITIES)), tmp_path / "out", jobs=2, progress=seen.append
    )
    assert {key: second.rows[key] for key in first.rows} == first.rows
    assert seen == [RunsProgress(3.0, 4, "2 at a time"), RunsProgress(4.0, 4, "2 at a time")]


@pytest.mark.long
def test_a_process_that_ends_is_a_failed_run_and_another_one_goes_on(trouble: Trouble) -> None:
    rows = rows_of(trouble, (*ANSWERS, "answer"), jobs=2)
    assert len(rows) == len(ANSWERS) + 1
    for name, row in rows.items():
        deed = name.split()[1]
        assert row.message == {
            "refuse": "field: found this; allowed is that. Mend it.",
            "fault": "ZeroDivisionError: a fault of a part",
            "kill": f"ended by a signal: {signal.strsignal(signal.SIGKILL)}",
        }.get(deed, "")
        assert (row.outcome is None) == (deed in ("refuse", "fault", "kill"))
        assert row.outcome is None or row.outcome.figure == 1.0, "threads"


def test_runs_share_as_many_processes_as_there_are_jobs(trouble: Trouble) -> None:
    rows = rows_of(trouble, ("answer",) * 8, jobs=2)
    processes = {row.outcome.seconds for row in rows.values() if row.outcome is not None}
    assert 1 <= len(processes) <= 2
    assert os.getpid() not in processes


def test_closing_ends_processes_in_the_middle_of_their_runs(trouble: Trouble) -> None:
    deeds = ("answer", "sleep", "sleep", "sleep")
    rows = run_apart(trouble, {str(number): {"do": deed} for number, deed in enumerate(deeds)}, 2)
    key, row = next(rows)
    assert key == "0"
    assert row.outcome is not None
    rows.close()
    with pytest.raises(ProcessLookupError):
        os.kill(int(row.outcome.seconds), 0)


@pytest.mark.long
def test_an_interrupted_study_keeps_what_is_done_and_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = falling_study(tmp_path, DENSITIES)

    def interrupt(now: RunsProgress) -> None:
        if now.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_study(load_study(path), tmp_path / "out", jobs=2, progress=interrupt)
    before = read_rows(tmp_path / "out" / "study.csv")
    assert 2 <= len(before) < 4
    after, _ = run_study(load_study(path), tmp_path / "out", jobs=2)
    assert len(after.rows) == 4
    assert {key: after.rows[key] for key in before} == before


@pytest.mark.skipif(sys.platform != "linux", reason="children are listed in /proc")
def test_processes_end_with_the_one_that_started_them(tmp_path: Path) -> None:
    """A study of runs that would last for hours is killed: nothing of it is left."""
    path = falling_study(tmp_path, "[set]\ntime.end = 1e5\ntime.step = 1e-3\n" + DENSITIES, figure='"steps"')
    study = subprocess.Popen(
        python("-m", "rigidfluid", "study", str(path), "--out", str(tmp_path / "out"), "-j", "2"), env=environment()
    )
    try:
        wait_for(lambda: len(workers_of(study.pid)) == 2)
        children = workers_of(study.pid)
    finally:
        study.kill()
        study.wait()
    wait_for(lambda: not any(Path(f"/proc/{child}/cmdline").exists() for child in children))


def workers_of(parent: int) -> list[int]:
    """Numbers of the processes of a study."""
    found = Path(f"/proc/{parent}/task").glob("*/children")
    return [int(word) for file in found for word in file.read_text().split()]


def wait_for(happens: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < end
        time.sleep(0.05)


@pytest.mark.parametrize("jobs", [0, -1, MOST_JOBS + 1])
def test_numbers_of_processes_that_cannot_be(jobs: int, tmp_path: Path) -> None:
    path = falling_study(tmp_path, DENSITIES)
    result = CliRunner().invoke(app, ["study", str(path), "-j", str(jobs)])
    assert result.exit_code == 2
    assert f"Error: jobs (-j): found {jobs}; allowed is 1 to {MOST_JOBS} on this machine" in result.stderr
    with pytest.raises(ArgumentError):
        run_study(load_study(path), tmp_path / "out", jobs=jobs)
