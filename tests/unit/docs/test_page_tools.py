"""Pages are made from kept runs, say what they were made from, and are named where that has changed."""

from __future__ import annotations

import csv
import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from benchmark_scripts import benchmark
from falling import SCENES
from matplotlib.figure import Figure
from page_tools import Page, Work, page, table
from page_tools.inputs import LOADED, SEVERAL, changed, hashes, merged, sources
from page_tools.kept_run import keep_run
from page_tools.record import CostTable, read_record
from page_tools.stale import stale

import rigidfluid
from rigidfluid.core.run.run import Progress
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import StepError

END = 0.004


def scene(end: float = END, **contact: float) -> Scene:
    """Two disks without a fluid, with an output half way."""
    tables = rigidfluid.load_scene(SCENES / "dry_bounce.toml", [f"time.end={end}", "time.step=5e-4"]).to_dict()
    tables["contact"] |= contact
    tables["output"]["every"] = end / 2
    return rigidfluid.scene_from_dict(tables)


def rows(folder: Path) -> list[dict[str, float]]:
    with (folder / "progress.csv").open() as file:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]


def stop_at(folder: Path, time: float) -> None:
    """Run as these tools do, and be interrupted after the step that reaches this time."""
    add = CostTable.add

    def interrupt(self: CostTable, now: Progress) -> None:
        add(self, now)
        if now.time >= time:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CostTable, "add", interrupt)
        with pytest.raises(KeyboardInterrupt):
            keep_run(scene(), folder)


def test_a_complete_run_is_read_and_not_repeated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = keep_run(scene(), tmp_path / "run")
    before = (tmp_path / "run" / "summary.json").stat().st_mtime_ns
    second = keep_run(scene(), tmp_path / "run")
    assert (tmp_path / "run" / "summary.json").stat().st_mtime_ns == before
    assert capsys.readouterr().out.splitlines()[1].endswith(": kept")
    assert second.summary == first.summary
    assert second.cpu_seconds == first.cpu_seconds > 0.0
    assert second.history.bodies["time"][-1] == pytest.approx(END)


def test_a_run_that_was_stopped_goes_on_to_the_same_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stop_at(tmp_path / "stopped", 0.65 * END)
    left = rows(tmp_path / "stopped")
    stopped, whole = keep_run(scene(), tmp_path / "stopped"), keep_run(scene(), tmp_path / "whole")
    assert ": goes on\n" in capsys.readouterr().out
    for name, column in whole.history.bodies.items():
        assert np.array_equal(stopped.history.bodies[name], column), name
    found = rows(tmp_path / "stopped")
    assert [row["time"] for row in found] == [row["time"] for row in rows(tmp_path / "whole")]
    assert found[0] == left[0]
    assert np.all(np.diff([row["cpu_seconds"] for row in found]) > 0.0)


def test_a_run_of_another_scene_is_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep_run(scene(), tmp_path / "run")
    softer = keep_run(scene(epsilon=1e-7), tmp_path / "run")
    assert "runs anew, since what is there is of another scene" in capsys.readouterr().out
    assert softer.summary["scene"]["contact"]["epsilon"] == 1e-7
    assert len(rows(tmp_path / "run")) == softer.summary["steps"]


def test_a_stopped_run_of_another_scene_is_replaced(tmp_path: Path) -> None:
    stop_at(tmp_path / "run", 0.5 * END)
    assert keep_run(scene(end=2 * END), tmp_path / "run").history.bodies["time"][-1] == pytest.approx(2 * END)
    assert rows(tmp_path / "run")[0]["time"] == pytest.approx(5e-4)


def test_a_stopped_run_whose_checkpoint_cannot_be_read_is_replaced(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stop_at(tmp_path / "run", 0.65 * END)
    (tmp_path / "run" / "state.h5").write_bytes(b"of another format")
    assert keep_run(scene(), tmp_path / "run").summary["status"] == "complete"
    assert "its checkpoint cannot be read" in capsys.readouterr().out


def test_fresh_runs_anew_what_is_complete(tmp_path: Path) -> None:
    keep_run(scene(), tmp_path / "run")
    before = (tmp_path / "run" / "summary.json").stat().st_mtime_ns
    keep_run(scene(), tmp_path / "run", fresh=True)
    assert (tmp_path / "run" / "summary.json").stat().st_mtime_ns > before


def test_a_run_may_stop_where_that_is_allowed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: Simulation, until: float = np.inf) -> None:
        self.step()
        raise StepError("a step", "none", "one", "Wait.")

    monkeypatch.setattr(Simulation, "go", fail)
    with pytest.raises(StepError):
        keep_run(scene(), tmp_path / "run")
    run = keep_run(scene(), tmp_path / "run", fresh=True, may_stop=True)
    assert run.summary["status"].startswith("stopped")
    assert run.summary["steps"] == 1


def test_a_run_that_was_made_elsewhere_is_used_and_said_to_be_of_unknown_sources(tmp_path: Path) -> None:
    rigidfluid.run(scene(), tmp_path / "page" / "run")
    work = Work("page", runs=tmp_path)
    run = work.run("run", scene())
    assert run.cpu_seconds == run.summary["cpu_time"]
    assert work.outdated == {"run": ["out/validation/page/run"]}
    assert "out/validation/page/run" in changed(work.inputs)


def test_a_run_of_unknown_sources_stays_one_when_it_goes_on(tmp_path: Path) -> None:
    stop_at(tmp_path / "page" / "run", 0.65 * END)
    (tmp_path / "page" / "run" / "made.json").unlink()
    work = Work("page", runs=tmp_path)
    work.run("run", scene())
    assert work.outdated == {"run": ["out/validation/page/run"]}


def test_a_file_that_is_edited_while_a_page_is_made_counts_as_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "src/rigidfluid/core/run/stepper.py"
    monkeypatch.setitem(LOADED, name, "as it was")
    assert changed(sources()) == [name]


def test_inputs_are_what_computes_and_the_files_that_were_read(tmp_path: Path) -> None:
    work = Work("page", runs=tmp_path)
    work.run("run", "dry_bounce.toml", [f"time.end={END}"])
    work.scene("insertion_3d.toml")
    for name in (
        "src/rigidfluid/core/run/stepper.py",
        "tests/support/falling.py",
        "scenes/dry_bounce.toml",
        "scenes/insertion_3d.toml",
        "scenes/insertion/bolt.stl",
    ):
        assert name in work.inputs
    assert not [name for name in work.inputs if "reports" in name or "page_tools" in name or "/unit/" in name]
    assert changed(work.inputs) == []
    assert work.outdated == {}


def test_a_page_is_no_input_of_its_runs(tmp_path: Path) -> None:
    """Its text may be edited, and its runs are no older for that."""
    import_module("pages.detectors")
    work = Work("page", runs=tmp_path)
    run = work.run("run", "dry_bounce.toml", [f"time.end={END}"])
    assert "docs/pages/detectors.py" in work.inputs
    assert "docs/pages/detectors.py" not in read_record(run.folder)


def test_a_study_is_kept_with_its_inputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = tmp_path / "bounce.toml"
    study.write_text(
        f"""[study]
name = "bounce"
scene = "{SCENES}/dry_bounce.toml"
[set]
time.end = 0.004
[vary]
time.step = [5e-4, 2.5e-4]
[error]
figure = "energy.kinetic"
reference = "finest"
"""
    )
    monkeypatch.setattr("page_tools.work.STUDIES", tmp_path)
    monkeypatch.setattr("page_tools.work.hashes", lambda files: {str(path): "" for path in files})
    first = Work("page", runs=tmp_path)
    results = first.study("bounce")
    again = Work("page", runs=tmp_path)
    assert again.study("bounce").rows == results.rows
    assert str(SCENES / "dry_bounce.toml") in again.inputs
    assert again.outdated == {}


def test_runs_by_several_versions_of_a_file_count_as_changed() -> None:
    now = sources()
    name = next(iter(now))
    assert changed(now) == []
    both = merged(now, now | {name: "older"})
    assert both[name] == SEVERAL
    assert changed(both) == [name]


def test_changed_code_makes_a_page_stale_and_prose_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("page_tools.inputs.ROOT", "page_tools.page.INPUTS", "page_tools.stale.INPUTS"):
        monkeypatch.setattr(module, tmp_path)
    source = tmp_path / "src.py"
    source.write_text("a = 1\n")
    page.write(Page("Page", "Text."), "page", {}, tmp_path)
    assert dict(stale(tmp_path, tmp_path)) == {"page": "made before its inputs were recorded"}
    page.write_inputs("page", hashes([source]), tmp_path)
    assert dict(stale(tmp_path, tmp_path)) == {}
    source.write_text('"""Prose."""\n\na = 1  # prose\n"""Prose."""\n')
    assert dict(stale(tmp_path, tmp_path)) == {}
    source.write_text("a = 2\n")
    assert dict(stale(tmp_path, tmp_path)) == {"page": "1 of 1 inputs have changed: src.py"}


def test_a_page_that_a_benchmark_writes_has_inputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with benchmark("written_page") as script:
        monkeypatch.setattr(script, "DOCS", tmp_path)
        monkeypatch.setattr(page, "INPUTS", tmp_path)
        monkeypatch.setattr(page.write_inputs, "__defaults__", (tmp_path / "inputs",))
        (tmp_path / "validation").mkdir()
        script.write_page(tmp_path / "elsewhere.md", "Text.")
        assert not (tmp_path / "inputs").exists()
        script.write_page(tmp_path / "validation" / "speed.md", "Text.")
    known = json.loads((tmp_path / "inputs" / "speed.json").read_text())
    assert {"src/rigidfluid/core/run/stepper.py", "benchmarks/written_page.py"} <= known.keys()
    assert changed(known) == []


def test_a_page_shows_its_figures_and_which_runs_are_older(tmp_path: Path) -> None:
    shown = Page(
        "Two disks",
        f"![Heights](two_heights.png)\n\n{table(('a', 'b'), [('1', '2')])}",
        {"": Figure(), "_heights": Figure()},
    )
    page.write(shown, "two", {"fine": ["src/a.py", "src/b.py"]}, tmp_path)
    text = (tmp_path / "two.md").read_text()
    assert text.startswith("# Two disks\n\nMade on ")
    assert "Of its runs, fine are older: 2 of their sources have changed since." in text
    assert "| a | b |\n| --- | --- |\n| 1 | 2 |" in text
    for name in ("two.png", "two_heights.png"):
        assert (tmp_path / name).stat().st_size > 0
        assert f"]({name})" in text


def test_a_figure_that_the_text_does_not_show_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"does not show two_heights\.png"):
        page.write(Page("Two", "Text.", {"_heights": Figure()}), "two", {}, tmp_path)
