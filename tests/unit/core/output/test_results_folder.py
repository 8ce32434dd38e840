"""A folder belongs to one run at a time, and nothing there is touched that is no result of the same kind."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from itertools import groupby
from operator import attrgetter
from pathlib import Path

import pytest
from dry_scenes import ball, dry_scene
from falling import SCENES, falling_disk
from typer.testing import CliRunner

import rigidfluid
from rigidfluid.cli import app
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.output.results_folder import take_folder
from rigidfluid.core.output.run_files import FILES, PICTURES, RUN
from rigidfluid.core.run.run import simulate
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import OutputError
from rigidfluid.post.comparison.compare import product_of
from rigidfluid.post.insertion import insert
from rigidfluid.post.movies import movie
from rigidfluid.post.reports import report
from rigidfluid.post.studies import load_study, run_study

ROOT = Path(__file__).parents[4]
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


TABLES = [f"{name}.csv" for name in columns(2)]


@pytest.mark.parametrize("name", [*TABLES, "state.h5", "summary.json", "fields/000000.vtu", "report/gap.png"])
def test_a_file_that_would_be_replaced_in_a_folder_of_no_run(tmp_path: Path, name: str) -> None:
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("years of work")
    before = contents(tmp_path)
    with pytest.raises(OutputError, match=rf"{name}: found a file of this name in a folder that is of no run"):
        rigidfluid.run(SCENE, tmp_path)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("content", ["", "12345\n", "mine", "1 writes this study of rigidfluid\n"])
def test_a_file_called_as_the_mark_is_not_taken_for_it(tmp_path: Path, content: str) -> None:
    (tmp_path / "run.lock").write_text(content)
    with pytest.raises(OutputError, match=r"run.lock: found a file that no run has written"):
        rigidfluid.run(SCENE, tmp_path)
    assert contents(tmp_path) == {tmp_path / "run.lock": content.encode()}


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("name", [*TABLES, "summary.json", "state.h5", "fields", "run.lock"])
def test_links_are_never_followed(tmp_path: Path, name: str, resume: bool) -> None:
    out, victim = tmp_path / "out", tmp_path / "victim"
    rigidfluid.run(SCENE, out)
    kept = out / name
    kept.rename(victim)
    kept.symlink_to(victim)
    before = contents(tmp_path)
    with pytest.raises(OutputError, match=rf"{name}: found a link; allowed is a (file|folder), or nothing"):
        rigidfluid.run(SCENE, out, resume=resume)
    assert contents(tmp_path) == before
    with pytest.raises(OutputError, match=rf"{name}: found a link"):
        report(out)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no named pipes there")
def test_a_pipe_in_the_place_of_a_table_is_not_opened(tmp_path: Path) -> None:
    rigidfluid.run(SCENE, tmp_path)
    (tmp_path / "bodies.csv").unlink()
    os.mkfifo(tmp_path / "bodies.csv")
    with pytest.raises(OutputError, match=r"bodies.csv: found a pipe; allowed is a file"):
        rigidfluid.run(SCENE, tmp_path)


def test_the_list_of_results_is_the_documentation_s() -> None:
    page = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    for files in FILES:
        assert f"| {files.shown} | {files.written} | {files.content} |" in page
    assert f"| `{RUN.mark}` | at the start |" in page


def test_so_is_that_of_the_readme() -> None:
    lines = [
        f"* {when}: {', '.join(one.shown for one in files)}" for when, files in groupby(FILES, attrgetter("written"))
    ]
    block = "\n".join(["<!-- files of a run, from core/output/run_files -->", *lines, f"* at the start: `{RUN.mark}`"])
    assert f"{block}\n<!-- end -->" in (ROOT / "README.md").read_text(encoding="utf-8"), f"put there\n{block}"


def test_each_file_of_a_run_and_its_report_is_on_the_list(tmp_path: Path) -> None:
    rigidfluid.run(SCENE, tmp_path)
    report(tmp_path)
    movie(tmp_path)
    assert {path for path in contents(tmp_path) if path.name != RUN.mark} == set(RUN.present(tmp_path))


@pytest.mark.parametrize("name", ["report.html", "report/gap.png", "movie.gif", "movie.mp4"])
def test_neither_a_run_nor_its_report_and_movie_replace_somebody_else_s(tmp_path: Path, name: str) -> None:
    """In a folder to which the files of a run were copied, without its mark."""
    rigidfluid.run(SCENE, tmp_path)
    (tmp_path / RUN.mark).unlink()
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("years of work")
    before = contents(tmp_path)
    for write in (report, movie, partial(rigidfluid.run, SCENE)):
        with pytest.raises(OutputError, match=r": found a file of this name in a folder that is of no run"):
            write(tmp_path)
    assert contents(tmp_path) == before


def test_a_folder_of_a_run_that_has_lost_its_mark_is_marked_again(tmp_path: Path) -> None:
    rigidfluid.run(SCENE, tmp_path)
    (tmp_path / RUN.mark).unlink()
    for _ in range(2):
        report(tmp_path)
        rigidfluid.run(SCENE, tmp_path)
        movie(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
def test_nothing_is_written_to_what_has_another_name(tmp_path: Path) -> None:
    """Hard links to each file, as a snapshot of the folder has."""
    out, kept = tmp_path / "out", tmp_path / "kept"
    kept.mkdir()
    rigidfluid.run(SCENE, out)
    report(out)
    movie(out)
    for file in set(contents(out)) - {out / RUN.mark}:
        (kept / file.name).hardlink_to(file)
    before = contents(kept)
    longer = SCENE.model_copy(update={"time": SCENE.time.model_copy(update={"end": 0.2})})
    with pytest.raises(OutputError, match=r"bodies.csv: found a file with 2 names \(hard links\)"):
        rigidfluid.run(longer, out, resume=True)
    report(out)
    movie(out)
    rigidfluid.run(longer, out)
    assert contents(kept) == before


@pytest.mark.skipif(sys.platform == "win32", reason="links need rights there")
@pytest.mark.parametrize("name", ["state.h5.part", "summary.json.part", "fields.pvd.part"])
def test_links_that_are_put_there_during_a_run_are_not_followed(tmp_path: Path, name: str) -> None:
    out, victim = tmp_path / "out", tmp_path / "victim"
    victim.write_text("years of work")

    def put_a_link(_: object) -> None:
        if not os.path.lexists(out / name):
            (out / name).symlink_to(victim)

    simulate(SCENE, out, progress=put_a_link)
    assert victim.read_text() == "years of work"
    assert not (out / "state.h5").is_symlink()


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


def refuse_a_file(folder: Path, name: str, write: Callable[[Path], object]) -> None:
    """A command leaves a file of somebody else as it is, and names it before it does anything."""
    (folder / name).write_text("years of work")
    with pytest.raises(OutputError, match=rf"{name}: found a file of this name in a folder that is of no "):
        write(folder)
    assert contents(folder) == {folder / name: b"years of work"}


MESHED = ["insertion.html", "insertion.json", "mesh.msh", "mesh.vtu", "mesh.png", "quality.png"]


@pytest.mark.parametrize("name", MESHED)
def test_an_insertion_replaces_nobody_else_s_files(tmp_path: Path, name: str) -> None:
    refuse_a_file(tmp_path, name, lambda out: insert(falling_disk(), out))


@pytest.mark.parametrize("name", ["study.csv", "study.html", "study.png"])
def test_a_study_replaces_nobody_else_s_files(tmp_path: Path, name: str) -> None:
    study = load_study(ROOT / "studies" / "falling_disk.toml")
    refuse_a_file(tmp_path, name, lambda out: run_study(study, out))


@pytest.mark.parametrize("name", ["comparison.json", "comparison.html", "body_3.png", "dry.toml", "scikit-fem.log"])
def test_a_comparison_replaces_nobody_else_s_files(tmp_path: Path, name: str) -> None:
    refuse_a_file(tmp_path, name, lambda out: take_folder(out, product_of(["dry", "scikit-fem"]), new=True))


def test_an_empty_name_is_not_the_working_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["run", str(SCENES / "dry_bounce.toml"), "--out", ""])
    assert result.exit_code == 2
    assert "an empty name" in result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", [" ", "\t", "a\nb", "\x1b[31mred", "a\x9bb"])
def test_a_name_that_cannot_be_seen_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.chdir(tmp_path)
    scene = str(SCENES / "dry_bounce.toml")
    commands = [["run", scene, "--out", name], ["insert", scene, "--out", name], ["movie", ".", "--out", name]]
    for command in [*commands, ["new", name], ["check", scene, "--json", name]]:
        result = CliRunner().invoke(app, command)
        assert result.exit_code == 2
        assert "an empty name" in result.stderr or "control character" in result.stderr
    assert not list(tmp_path.iterdir())
