"""Pages that no longer follow from what is here are named: by their files, their words and the first steps of runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from falling import SCENES
from page_tools import Page, Work, page
from page_tools.first_steps import ROUND_OFF, Steps, difference, first_steps, steps_of
from page_tools.record import Record, RunRecord, read_record
from page_tools.stale import stale, steps_again, unseen

import rigidfluid

OVERRIDES = ["time.end=0.004", "time.step=5e-4"]
FALLING = ["time.end=0.004", "time.step=0.001", "mesh.size=0.5", "mesh.size_body=0.1"]


def never(run: RunRecord) -> Steps:
    raise AssertionError("no run is made again")


@pytest.fixture
def made(tmp_path: Path) -> Record:
    """The record of a page of one dry run."""
    work = Work("two", runs=tmp_path / "runs")
    work.run("run", "dry_bounce.toml", OVERRIDES)
    page.write(Page("Two", "Text."), "two", work, tmp_path)
    record = read_record("two", tmp_path / "records")
    assert record is not None
    return record


def told(folder: Path, record: Record, again: object = never) -> dict[str, str]:
    record.write("two", folder / "records")
    return dict(stale(["two"], again, folder, folder / "records"))  # type: ignore[arg-type]


def test_a_page_of_the_present_sources_is_not_stale_and_nothing_is_run(tmp_path: Path, made: Record) -> None:
    assert told(tmp_path, made) == {}


def test_a_page_that_was_edited_is_stale(tmp_path: Path, made: Record) -> None:
    (tmp_path / "two.md").write_text((tmp_path / "two.md").read_text() + "More.\n")
    assert "two.md is not as it was written" in told(tmp_path, made)["two"]


def test_a_page_whose_module_says_something_else_is_stale(tmp_path: Path, made: Record) -> None:
    assert (
        "docs/pages/walls.py says something else"
        in told(tmp_path, replace(made, texts={"docs/pages/walls.py": "other"}))["two"]
    )


def test_a_page_without_a_record_is_stale(tmp_path: Path) -> None:
    assert dict(stale(["two"], never, tmp_path, tmp_path)) == {"two": "has no record; make it"}


def test_other_sources_with_the_same_results_leave_a_page_as_it_is(tmp_path: Path, made: Record) -> None:
    assert told(tmp_path, replace(made, sources=("others",)), steps_again) == {}


def test_other_results_make_a_page_stale(tmp_path: Path, made: Record) -> None:
    """As by sources with another gravity."""

    def again(run: RunRecord) -> Steps:
        overrides = [*run.settings.overrides, "fluid.gravity=[0.0, -982.0]"]
        return steps_again(replace(run, settings=replace(run.settings, overrides=overrides)))

    assert "run has other results" in told(tmp_path, replace(made, sources=("others",)), again)["two"]


def test_a_scene_that_is_refused_now_makes_a_page_stale(tmp_path: Path, made: Record) -> None:
    run = made.runs["run"]
    refused = replace(run, settings=replace(run.settings, overrides=["time.stop=1.0"]))
    record = replace(made, sources=("others",), runs={"run": refused})
    assert "run does not run: " in told(tmp_path, record, steps_again)["two"]


def test_a_run_by_a_part_that_is_not_here_tells_nothing(tmp_path: Path, made: Record) -> None:
    run = made.runs["run"]
    other = replace(run, settings=replace(run.settings, overrides=["fluid.backend=nowhere"]))
    assert told(tmp_path, replace(made, sources=("others",), runs={"run": other}), steps_again) == {}


def test_a_page_of_other_sources_without_runs_is_told_apart(tmp_path: Path, made: Record) -> None:
    old = replace(made, runs={}, sources=(), commit="1234567", cpu_seconds=None)
    assert told(tmp_path, old) == {}
    assert dict(unseen(["two"], tmp_path / "records")) == {"two": f"made on {old.made} at 1234567, in an unknown time"}
    made.write("two", tmp_path / "records")
    assert dict(unseen(["two"], tmp_path / "records")) == {}


def test_first_steps_are_those_of_the_whole_run(tmp_path: Path) -> None:
    """In a fluid, to the last digit that is kept."""
    scene = rigidfluid.load_scene(SCENES / "falling_disk.toml", FALLING)
    whole, first = steps_of(rigidfluid.run(scene)), first_steps(scene, 4)
    assert list(first) == ["1", "2", "4"]
    assert first == {step: whole[step] for step in first}
    assert difference(whole, first) == 0.0
    finer = first_steps(rigidfluid.load_scene(SCENES / "falling_disk.toml", [*FALLING, "mesh.size_body=0.099"]), 2)
    assert difference(whole, finer) > 1e3 * ROUND_OFF


def test_differences_are_over_the_largest_of_a_quantity() -> None:
    still = {"position": 2.0, "velocity": 0.0, "force": 0.0}
    known = {"1": still, "2": still | {"velocity": 4.0}}
    assert difference(known, known) == 0.0
    assert difference(known, {"1": still | {"velocity": 1e-9}}) == float("inf")  # nothing to measure it by
    assert difference(known, {"1": still | {"velocity": 1e-9}, "2": known["2"]}) == pytest.approx(2.5e-10)
    assert difference(known, {"4": still}) == float("inf")
