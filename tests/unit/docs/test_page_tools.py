"""Pages are made from kept runs, and have a record of what made them."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from benchmark_scripts import benchmark
from falling import SCENES
from matplotlib.figure import Figure
from page_tools import Page, Work, page, table
from page_tools.cost_table import CostTable
from page_tools.kept_rows import KeptRows
from page_tools.kept_run import keep_run
from page_tools.made import UNKNOWN, Made
from page_tools.provenance import commit, file_digest, source_digest, text_digest
from page_tools.record import read_record
from page_tools.settings import Settings, settings_of

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
    assert work.outdated == {"run": UNKNOWN}
    assert work.sources == (UNKNOWN, source_digest())


def test_a_run_of_other_sources_stays_one_when_it_goes_on(tmp_path: Path) -> None:
    stop_at(tmp_path / "page" / "run", 0.65 * END)
    Made(("before",), ("others",)).write(tmp_path / "page" / "run")
    work = Work("page", runs=tmp_path)
    work.run("run", scene())
    assert work.outdated == {"run": f"before, {commit()}"}
    assert work.sources == ("others", source_digest())


def test_runs_of_other_sources_are_made_anew_where_the_present_are_asked_for(tmp_path: Path) -> None:
    keep_run(scene(), tmp_path / "page" / "run")
    before = (tmp_path / "page" / "run" / "summary.json").stat().st_mtime_ns
    work = Work("page", present=True, runs=tmp_path)
    work.run("run", scene())
    assert (tmp_path / "page" / "run" / "summary.json").stat().st_mtime_ns == before
    Made(("before",), ("others",)).write(tmp_path / "page" / "run")
    work = Work("page", present=True, runs=tmp_path)
    work.run("run", scene())
    assert (tmp_path / "page" / "run" / "summary.json").stat().st_mtime_ns > before
    assert work.outdated == {}
    assert work.sources == (source_digest(),)


def test_rows_are_measured_once_and_kept_with_what_has_made_them(tmp_path: Path) -> None:
    asked: list[int] = []

    def rows_from(**how: bool) -> tuple[Work, object]:
        work = Work("page", runs=tmp_path, measured=tmp_path / "measured", **how)
        return work, work.rows(lambda: [{"gap": 0.1 * len(asked), "number": asked.append(0) or len(asked)}])

    assert rows_from()[1] == rows_from()[1] == [{"gap": 0.0, "number": 1}]
    kept = KeptRows.read(tmp_path / "measured" / "page.json")
    assert kept.made.is_present
    assert rows_from(fresh=True)[1] == [{"gap": 0.1, "number": 2}]
    KeptRows(Made(("before",), ("others",), 1000.0), list(kept.rows)).write(tmp_path / "measured" / "page.json")
    older, rows = rows_from()
    assert rows == kept.rows
    assert (older.outdated, older.sources) == ({"rows": "before"}, ("others", source_digest()))
    assert older.cpu_seconds >= 1000.0
    present, rows = rows_from(present=True)
    assert rows == [{"gap": 0.2, "number": 3}]
    assert (present.outdated, len(asked)) == ({}, 3)


def test_cases_that_were_measured_before_a_stop_are_not_measured_again(tmp_path: Path) -> None:
    asked: list[str] = []

    def cases_of(*names: str, **how: bool) -> list[dict[str, object]]:
        def measure(name: str) -> list[dict[str, object]]:
            if name == "stopped":
                raise KeyboardInterrupt
            asked.append(name)
            return [{"found": name}]

        work = Work("page", runs=tmp_path, measured=tmp_path / "measured", **how)
        return list(work.cases({name: partial(measure, name) for name in names}))

    with pytest.raises(KeyboardInterrupt):
        cases_of("first", "stopped")
    assert cases_of("first", "second") == [{"case": name, "found": name} for name in ("first", "second")]
    assert asked == ["first", "second"]
    assert cases_of("second") == [{"case": "second", "found": "second"}]
    cases_of("first", fresh=True)
    assert asked == ["first", "second", "first"]


def test_rows_that_no_file_can_hold_replace_none(tmp_path: Path) -> None:
    KeptRows(Made(), [{"gap": 0.1}]).write(tmp_path / "page.json")
    with pytest.raises(ValueError, match="JSON"):
        KeptRows(Made(), [{"gap": np.inf}]).write(tmp_path / "page.json")
    assert KeptRows.read(tmp_path / "page.json").rows == [{"gap": 0.1}]


def test_a_run_is_recorded_by_a_command_that_makes_it(tmp_path: Path) -> None:
    work = Work("page", runs=tmp_path)
    run = work.run("run", "dry_bounce.toml", [f"time.end={END}"])
    recorded = work.runs["run"]
    assert recorded.command == f"rigidfluid run scenes/dry_bounce.toml --set time.end={END}"
    assert recorded.settings.scene.to_dict() == run.scene.to_dict()
    assert recorded.commits == (commit(),)
    assert list(recorded.steps) == [str(number) for number in (1, 2, 4, 8, 16, 32) if number <= run.summary["steps"]]


@pytest.mark.parametrize(
    ("file", "change"),
    [
        ("dry_bounce.toml", lambda tables: tables["body"][1].update(density=2.5, position=[0.7, 0.6])),
        ("falling_disk_window.toml", lambda tables: tables["domain"].pop("window")),
        ("vortex_induced.toml", lambda tables: tables["body"][0].pop("spring")),
        ("ellipse_xia.toml", lambda tables: tables.update(boundary=[{"on": "all", "type": "wall"}])),
    ],
)
def test_a_scene_made_from_a_file_is_told_by_its_settings(file: str, change: object) -> None:
    tables = rigidfluid.load_scene(SCENES / file).to_dict()
    change(tables)  # type: ignore[operator]
    changed = rigidfluid.scene_from_dict(tables)
    settings = settings_of(changed)
    assert settings.file == f"scenes/{file}"
    assert settings.overrides
    assert settings.scene.to_dict() == changed.to_dict()


def test_a_scene_without_a_file_is_told_by_its_tables() -> None:
    tables = scene().to_dict()
    tables["scene"]["name"] = "nobody_knows_it"
    settings = settings_of(rigidfluid.scene_from_dict(tables))
    assert settings.command == ""
    assert settings.scene.to_dict() == tables


def test_cpu_time_of_kept_runs_counts(tmp_path: Path) -> None:
    keep_run(scene(), tmp_path / "page" / "run")
    summary = tmp_path / "page" / "run" / "summary.json"
    summary.write_text(json.dumps(json.loads(summary.read_text()) | {"cpu_time": 1000.0}))
    work = Work("page", runs=tmp_path)
    work.run("run", scene())
    assert 1000.0 <= work.cpu_seconds < 1100.0


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
    first = Work("page", runs=tmp_path)
    results = first.study("bounce")
    again = Work("page", runs=tmp_path)
    assert again.study("bounce").rows == results.rows
    assert again.outdated == {}
    assert Made.read(tmp_path / "page" / "study_bounce").cpu_seconds > 0.0
    watched = again.runs["study bounce"]
    assert watched.command == "rigidfluid run scenes/dry_bounce.toml --set time.end=0.004 --set time.step=0.0005"
    assert list(watched.steps) == ["1", "2", "4"]


def test_names_change_nothing_that_a_module_says(tmp_path: Path) -> None:
    module = tmp_path / "page.py"
    module.write_text('from a import b\nTEXT = "Two words"\nb(TEXT, "column", 3)\n')
    before = text_digest(module)
    module.write_text('"""Prose."""\nfrom c import d\nSAID = "Two words"  # prose\nd(SAID, "other_column", 3)\n')
    assert text_digest(module) == before
    for text in ('SAID = "Two other words"\nd(SAID, "column", 3)\n', 'SAID = "Two words"\nd(SAID, "column", 4)\n'):
        module.write_text(text)
        assert text_digest(module) != before


def test_a_page_that_a_benchmark_writes_has_a_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with benchmark("written_page") as script:
        monkeypatch.setattr(script, "DOCS", tmp_path)
        (tmp_path / "validation").mkdir()
        script.write_page(tmp_path / "elsewhere.md", "Text.")
        script.write_page(tmp_path / "validation" / "speed.md", "Text.")
    assert not (tmp_path / "records").exists()
    record = read_record("speed", tmp_path / "validation" / "records")
    assert record is not None
    assert record.commit == commit()
    assert record.edited(tmp_path / "validation") == []
    assert record.making in (tmp_path / "validation" / "speed.md").read_text()
    replace(record, made="before", commit="1").write("speed", tmp_path / "validation" / "records")
    with benchmark("written_page") as script:
        monkeypatch.setattr(script, "DOCS", tmp_path)
        script.write_page(tmp_path / "validation" / "speed.md", "Other text.", kept=True)
    record = read_record("speed", tmp_path / "validation" / "records")
    assert record is not None
    assert (record.made, record.commit) == ("before", "1")
    assert record.edited(tmp_path / "validation") == []


def test_what_a_benchmark_measures_is_kept_beside_its_page(tmp_path: Path) -> None:
    with benchmark("written_page") as script:
        found = script.measurement(tmp_path / "speed.md", [{"seconds": 1.5}])
        assert found["rows"] == [{"seconds": 1.5}]
        assert script.measurement(tmp_path / "speed.md") == found


def shown(text: str = "Text.") -> Page:
    figures = {"": Figure(), "_heights": Figure()}
    return Page("Two disks", f"![Heights](two_heights.png)\n\n{text}\n\n{table(('a', 'b'), [('1', '2')])}", figures)


def test_a_page_shows_its_figures_and_what_made_it(tmp_path: Path) -> None:
    work = Work("two", runs=tmp_path / "runs")
    work.run("run", scene())
    page.write(shown(), "two", work, tmp_path)
    text = (tmp_path / "two.md").read_text()
    assert text.startswith("# Two disks\n\nMade on ")
    assert f"at {commit()}, in " in text
    assert "Older, made at" not in text
    assert "| a | b |\n| --- | --- |\n| 1 | 2 |" in text
    for name in ("two.png", "two_heights.png"):
        assert (tmp_path / name).stat().st_size > 0
        assert f"]({name})" in text
    record = read_record("two", tmp_path / "records")
    assert record is not None
    assert record.runs == work.runs
    assert set(record.files) == {"two.md", "two.png", "two_heights.png"}
    assert record.versions["numpy"] == np.__version__
    assert record.is_present is False  # since its files are elsewhere
    assert record.edited(tmp_path) == []
    assert replace(record, files={}).is_present
    assert not replace(record, files={}, sources=("others",)).is_present


def test_a_page_says_which_of_its_runs_are_older(tmp_path: Path) -> None:
    work = Work("two", runs=tmp_path / "runs")
    keep_run(scene(), work.folder / "run")
    Made(("before",), ("others",)).write(work.folder / "run")
    work.run("run", scene())
    page.write(shown(), "two", work, tmp_path)
    assert "Older, made at before: run." in (tmp_path / "two.md").read_text()


def test_a_figure_that_the_text_does_not_show_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"does not show two_heights\.png"):
        page.write(Page("Two", "Text.", {"_heights": Figure()}), "two", Work("two", runs=tmp_path), tmp_path)


def test_a_record_holds_its_settings(tmp_path: Path) -> None:
    work = Work("two", runs=tmp_path / "runs")
    work.run("run", scene(epsilon=1e-7))
    page.write(Page("Two", "Text."), "two", work, tmp_path)
    record = read_record("two", tmp_path / "records")
    assert record is not None
    assert isinstance(record.runs["run"].settings, Settings)
    assert record.runs["run"].settings.scene.to_dict() == scene(epsilon=1e-7).to_dict()
    assert file_digest(tmp_path / "two.md") == record.files["two.md"]
