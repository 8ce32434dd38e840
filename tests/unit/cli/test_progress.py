"""Lines of progress where there is no terminal."""

from __future__ import annotations

import pytest

from rigidfluid.cli import console
from rigidfluid.cli.progress import progress_bar, progress_lines
from rigidfluid.core.output.history import History
from rigidfluid.core.run.process import Launch
from rigidfluid.core.run.run import Progress
from rigidfluid.core.scene.run_tables import TimeTable


def told(seconds_of_a_step: float, first: int, last: int, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """Lines of a run of a hundred steps of .01, from one step to another."""
    show = progress_lines("fall")
    for step in range(first, last + 1):
        show(progress(0.01 * step, seconds_of_a_step * (step - first + 1)))
    return capsys.readouterr().err.splitlines()


def progress(time: float, elapsed: float) -> Progress:
    return Progress(time=time, end=1.0, step=0.01, gap=1.0, elapsed=elapsed, failed_remeshes=0, history=History(2))


def test_a_line_every_ten_seconds_says_how_far_and_how_long(capsys: pytest.CaptureFixture[str]) -> None:
    lines = told(2.5, 1, 100, capsys)
    assert len(lines) == 24
    assert lines[0] == "fall: time 0.05 of 1, 5%, step 0.01, some 0:03:58 to go"
    assert lines[-1] == "fall: time 0.97 of 1, 97%, step 0.01, some 0:00:08 to go"


def test_a_run_of_less_than_ten_seconds_tells_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert told(0.1, 1, 100, capsys) == []


def test_a_run_that_goes_on_reckons_with_its_own_speed(capsys: pytest.CaptureFixture[str]) -> None:
    assert told(10.0, 81, 83, capsys)[0] == "fall: time 0.82 of 1, 82%, step 0.01, some 0:03:00 to go"


def test_the_first_process_alone_tells(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("rigidfluid.cli.progress.SECONDS_OF_A_LINE", 0.0)
    for rank in (0, 1):
        monkeypatch.setattr(console, "LAUNCH", Launch(rank, 2))
        with progress_bar("fall", TimeTable(end=1.0, step=0.1)) as show:
            show(progress(0.1, 1.0))
            show(progress(0.2, 2.0))
        assert ("fall: time 0.2 of 1, 20%" in capsys.readouterr().err) == (rank == 0)
