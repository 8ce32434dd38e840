"""Studies over physical parameters: groups, their references, and the plot over a parameter."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling_study import check_refusal, command, falling_study

from rigidfluid.api import run
from rigidfluid.errors import SceneError
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.model import FigureTable
from rigidfluid.post.studies.parameter_plot import parameter_plot
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.slope import read_slope
from rigidfluid.post.studies.subject import Outcome
from rigidfluid.post.studies.table import read_rows

GRAVITY = "[parameters]\nfluid.gravity.1 = [-20.0, -10.0]\n"
STEPS = "[vary]\ntime.step = [0.25, 0.125]\n"


def rows(out: Path) -> list[dict[str, str]]:
    with (out / "study.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def results_of(path: Path) -> Results:
    return run_study(load_study(path), path.parent / "out")[0]


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs whose figure is gravity times 1 + step, and fails at positive gravity."""

    def run(self: SceneSubject, settings: dict[str, Any], _: object) -> Outcome:
        gravity, step = settings["fluid.gravity.1"], settings.get("time.step", 0.25)
        if gravity > 0.0:
            raise SceneError("gravity", gravity, "down", "Turn it.")
        return Outcome(gravity * (1.0 + step), -gravity, 0, round(0.5 / step))

    monkeypatch.setattr(SceneSubject, "run", run)


def test_a_figure_for_each_value_without_a_reference(tmp_path: Path) -> None:
    path = falling_study(tmp_path, GRAVITY)
    result = command(path)
    assert result.exit_code == 0, result.stderr
    assert "2 runs, 0 failed\n" in result.stdout
    assert "Pareto" not in result.stdout
    found = rows(tmp_path / "out")
    assert [row["fluid.gravity.1"] for row in found] == ["-20.0", "-10.0"]
    assert [float(row["figure"]) for row in found] == pytest.approx([5.0 - 20 / 8, 5.0 - 10 / 8], rel=1e-9)
    assert [row["error"] for row in found] == ["", ""]
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert "Reference: none." in page
    assert "No run has an error" not in page
    assert "CPU time of one run" in page


@pytest.mark.usefixtures("coarse")
def test_each_group_has_the_reference_of_its_finest_run(tmp_path: Path) -> None:
    results = results_of(falling_study(tmp_path, GRAVITY + STEPS, error='reference = "finest"\nrelative = true'))
    found = rows(tmp_path / "out")
    assert [(row["fluid.gravity.1"], row["time.step"]) for row in found] == [
        (gravity, step) for gravity in ("-20.0", "-10.0") for step in ("0.25", "0.125")
    ]
    assert [float(row["error"]) for row in found] == pytest.approx([0.125 / 1.125, 0.0] * 2)
    assert sorted(set(results.references.values())) == pytest.approx([-22.5, -11.25])
    assert results.reference is None
    assert results.front == [results.prints[0], results.prints[2]]


@pytest.mark.usefixtures("coarse")
def test_a_group_whose_runs_all_fail_has_no_reference(tmp_path: Path) -> None:
    path = falling_study(tmp_path, GRAVITY.replace("-20.0", "20.0") + STEPS, error='reference = "finest"')
    results = results_of(path)
    assert [row["status"] for row in rows(tmp_path / "out")] == ["failed", "failed", "complete", "complete"]
    assert list(results.errors.values()) == pytest.approx([1.25, 0.0])
    assert parameter_plot(results).axes[0].lines[0].get_xdata() == pytest.approx([-10.0])


@pytest.mark.usefixtures("coarse")
def test_the_plot_is_over_the_parameter_with_a_line_for_each_setting(tmp_path: Path) -> None:
    tables = GRAVITY + "body.0.density = [1.0, 2.0]\n" + STEPS
    figure = parameter_plot(results_of(falling_study(tmp_path, tables, error='reference = "finest"')))
    above, below = figure.axes
    assert below.get_xlabel() == "fluid.gravity.1"
    assert len(above.lines) == 4
    for line, step in zip(above.lines, (0.25, 0.125) * 2, strict=True):
        assert line.get_xdata() == pytest.approx([-20.0, -10.0])
        assert line.get_ydata() == pytest.approx([-20.0 * (1 + step), -10.0 * (1 + step)])
    assert len({(line.get_color(), line.get_marker()) for line in above.lines}) == 4
    assert [line.get_ydata() for line in below.lines] == [pytest.approx([2.5, 1.25])] * 2
    names = {text.get_text() for text in figure.legends[0].get_texts()}
    assert names == {"density 1.0", "density 2.0", "step 0.25", "step 0.125"}


def test_values_that_are_no_numbers_are_ticks(tmp_path: Path) -> None:
    path = falling_study(tmp_path, '[parameters]\ncontact.law = ["normal", "centre"]\n')
    axes = parameter_plot(results_of(path)).axes[0]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["normal", "centre"]
    assert axes.lines[0].get_xdata() == pytest.approx([0.0, 1.0])


@pytest.mark.usefixtures("coarse")
def test_values_far_apart_are_on_a_logarithmic_axis(tmp_path: Path) -> None:
    path = falling_study(tmp_path, "[parameters]\nbody.0.density = [1.0, 30.0]\nfluid.gravity.1 = [-1.0]\n")
    assert parameter_plot(results_of(path)).axes[0].get_xscale() == "log"


@pytest.mark.parametrize(
    ("tables", "texts"),
    [
        ("", ("vary: found nothing", "[vary], [parameters] or [random]")),
        (GRAVITY.replace("gravity", "gravty"), ("fluid.gravty", "a key that nothing reads", "Did you mean 'gravity'?")),
        ("[parameters]\nbody.0.density = ['heavy']\n", ("body.0.density", "'heavy'", "a valid number")),
        ("[parameters]\nbody.0.density = 2.0\n", ("parameters.body.0.density", "2.0", "a list", "in brackets: [2.0]")),
        ("[parameters]\nbody.0.density = []\n", ("parameters.body.0.density", "[]", "at least 1 entry")),
        (GRAVITY + "[vary]\nfluid.gravity.1 = [-1.0]\n", ("parameters.fluid.gravity.1", "a key of [vary] too")),
        (f"[parameters]\nbody.0.density = {[1.0] * 5001}\n{STEPS}", ("parameters", "10002 runs", "at most 10000")),
        (f'group = "time.step"\n{GRAVITY}{STEPS}', ("study.group", "nothing with parameters")),
    ],
)
def test_wrong_parameters(tables: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    check_refusal(command(falling_study(tmp_path, tables)), *texts)


def test_a_relative_error_wants_a_reference(tmp_path: Path) -> None:
    result = command(falling_study(tmp_path, GRAVITY, error="relative = true"))
    assert "error.reference: found nothing; allowed is another number with relative = true" in result.stderr


def test_kernels_have_no_physical_parameters(tmp_path: Path) -> None:
    path = tmp_path / "kernel.toml"
    path.write_text('[study]\nname = "gaps"\nkernel = "detector"\n[parameters]\nbodies = [2, 3]\n')
    assert "parameters: found a table; allowed is nothing with study.kernel. Call it [vary]." in command(path).stderr


SLOPES = '[set]\noutput.sensitivities = ["fluid.gravity.1"]\n'


def test_slopes_are_drawn_where_runs_have_derivatives(tmp_path: Path) -> None:
    results = results_of(falling_study(tmp_path, SLOPES + GRAVITY))
    assert [float(row["slope"]) for row in rows(tmp_path / "out")] == pytest.approx([1 / 8] * 2, rel=1e-6)
    drawn = parameter_plot(results).axes[0].lines[-2:]
    rises = [np.ptp(line.get_ydata()) / np.ptp(line.get_xdata()) for line in drawn]
    assert rises == pytest.approx([1 / 8] * 2, rel=1e-6)
    assert len(parameter_plot(results).axes[0].lines) == 3
    again = read_rows(tmp_path / "out" / "study.csv")
    assert [row.outcome.slope for row in again.values() if row.outcome] == [o.slope for o in results.outcomes.values()]


def test_slopes_are_left_out_where_runs_have_none(tmp_path: Path) -> None:
    results = results_of(falling_study(tmp_path, GRAVITY))
    assert [row["slope"] for row in rows(tmp_path / "out")] == ["", ""]
    assert len(parameter_plot(results).axes[0].lines) == 1


@pytest.mark.parametrize(
    ("figure", "slope"),
    [
        ({"column": "vy", "extreme": "lowest"}, 0.5),
        ({"column": "y", "extreme": "highest"}, 0.0),
        ({"column": "vy", "at": 0.3}, 0.3),
        ({"column": "gap", "at": 0.3}, None),
    ],
)
def test_slopes_are_those_at_the_time_of_the_figure(tmp_path: Path, figure: dict[str, Any], slope: Any) -> None:
    results = results_of(falling_study(tmp_path, SLOPES + GRAVITY))
    scene = SceneSubject(results.study)._scene({"fluid.gravity.1": -10.0})
    found = read_slope(FigureTable(table="bodies", **figure), run(scene), "fluid.gravity.1")
    assert found == (slope if slope is None else pytest.approx(slope, rel=1e-6, abs=1e-9))
