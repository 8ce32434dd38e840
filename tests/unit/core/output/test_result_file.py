"""Whatever lies in the place of a run's file is refused by its name, and never waited for."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene

import rigidfluid
from rigidfluid.api import load_results
from rigidfluid.core.output import result_file
from rigidfluid.core.output.summary_file import read_summary
from rigidfluid.core.output.tables import Prefix
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import read_results
from rigidfluid.post.studies.table import read_rows

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are neither pipes nor devices there")

SCENE = dry_scene({}, ball([0.5, 0.5], [0.1, 0.0]), end=0.02, step=0.01)
ODD: dict[str, Callable[[Path], object]] = {
    "a pipe or a device": os.mkfifo,
    "a folder": Path.mkdir,
    "a pipe or a device ": lambda path: path.symlink_to("/dev/zero"),
}


@pytest.fixture(autouse=True)
def _no_end_is_an_error() -> Iterator[None]:
    def give_up(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(30)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    rigidfluid.run(SCENE, tmp_path)
    return tmp_path


@pytest.mark.parametrize("odd", ODD)
@pytest.mark.parametrize("name", ["summary.json", "bodies.csv", "contacts.csv", "energy.csv", "fields.pvd"])
def test_results_are_read_from_regular_files_alone(folder: Path, name: str, odd: str) -> None:
    (folder / name).unlink()
    ODD[odd](folder / name)
    with pytest.raises(OutputError, match=rf"{name}: found .*, which is {odd.strip()}; allowed is a regular file"):
        read_results(folder)


@pytest.mark.parametrize("odd", ODD)
@pytest.mark.parametrize("read", [read_results, load_results])
def test_so_is_a_checkpoint(folder: Path, read: Callable[[Path], object], odd: str) -> None:
    for name in ("summary.json", "state.h5"):
        (folder / name).unlink()
    ODD[odd](folder / "state.h5")
    with pytest.raises(OutputError, match=rf"state.h5: found .*, which is {odd.strip()}; allowed is a regular file"):
        read(folder)


@pytest.mark.parametrize("name", ["steps", "joints", "contacts", "probes"])
def test_so_are_tables_that_are_asked_for(folder: Path, name: str) -> None:
    results = load_results(folder)
    (folder / f"{name}.csv").unlink()
    os.mkfifo(folder / f"{name}.csv")
    with pytest.raises(OutputError, match=rf"{name}.csv: found .*, which is a pipe or a device"):
        results.table(name)


@pytest.mark.parametrize("read", [read_vtu, read_rows])
def test_so_are_fields_and_tables_of_studies(tmp_path: Path, read: Callable[[Path], object]) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OutputError, match=r"pipe: found .*, which is a pipe or a device"):
        read(tmp_path / "pipe")


def test_a_table_of_a_checkpoint_is_a_regular_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OutputError, match=r"pipe: found no regular file"):
        Prefix(3).require(tmp_path / "pipe")


def test_a_file_larger_than_the_memory_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(result_file, "available_memory", lambda: 2.0**30)
    with (folder / "summary.json").open("r+b") as file:
        file.truncate(1 << 31)  # holes take no room
    with pytest.raises(OutputError, match=r"summary.json of 2048 MiB; allowed is at most 1024 MiB"):
        read_summary(folder / "summary.json")


def test_a_table_with_a_line_of_no_table_is_refused(folder: Path) -> None:
    (folder / "bodies.csv").write_text("step," + "x" * 200_000 + "\n")
    with pytest.raises(OutputError, match=r"bodies.csv: found field larger than field limit"):
        read_results(folder)
