"""Studies of random samples: distributions, quantiles and Sobol indices, compared with those known in closed form."""

from __future__ import annotations

import csv
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling_study import check_refusal, command, falling_study

from rigidfluid.errors import SceneError
from rigidfluid.post.studies import load_study, run_study
from rigidfluid.post.studies.distributions import LogUniform, Normal, Uniform
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.samples_plot import samples_plot
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.sobol import sobol_indices
from rigidfluid.post.studies.subject import Outcome

TIME = 0.5
GRAVITY = 'fluid.gravity.1 = { distribution = "uniform", low = -20.0, high = -10.0 }\n'
SPEED = 'body.0.velocity = { distribution = "uniform", low = -1.0, high = 1.0 }\n'.replace("velocity", "velocity.1")
HEIGHT = 'body.0.position.1 = { distribution = "normal", mean = 5.0, deviation = 0.2 }\n'
DENSITY = 'body.0.density = { distribution = "log-uniform", low = 1.0, high = 4.0 }\n'
AT_REST = "[set]\nbody.0.velocity = [0.0, 0.0]\n"


def random_table(number: int, *parameters: str, more: str = "") -> str:
    return f"{AT_REST}[random]\nnumber = {number}\n{more}\n[random.parameters]\n{''.join(parameters)}"


def results_of(path: Path) -> Results:
    return run_study(load_study(path), path.parent / "out")[0]


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def product(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs whose figure is density times speed."""

    def run(self: SceneSubject, settings: dict[str, Any], _: object) -> Outcome:
        return Outcome(settings["body.0.density"] * settings["body.0.velocity.1"], 0.1, 0, 2)

    monkeypatch.setattr(SceneSubject, "run", run)


def test_quantile_functions_are_those_of_the_distributions() -> None:
    parts = np.array([0.0, 0.25, 0.5, 1.0])
    uniform = Uniform(distribution="uniform", low=-1.0, high=3.0)
    assert uniform.quantile(parts) == pytest.approx([-1.0, 0.0, 1.0, 3.0])
    ratio = LogUniform(distribution="log-uniform", low=1.0, high=16.0)
    assert ratio.quantile(parts) == pytest.approx([1.0, 2.0, 4.0, 16.0])
    normal = Normal(distribution="normal", mean=2.0, deviation=0.5)
    assert normal.quantile(np.array([0.158655254, 0.5, 0.841344746])) == pytest.approx([1.5, 2.0, 2.5])


@pytest.mark.parametrize("more", ["", "indices = true"])
def test_samples_follow_their_seed_and_more_of_them_begin_alike(more: str, tmp_path: Path) -> None:
    few, many, other = (
        load_study(falling_study(tmp_path, random_table(number, GRAVITY, HEIGHT, more=f"{more}\nseed = {seed}"))).groups
        for number, seed in ((8, 3), (16, 3), (8, 4))
    )
    assert many[: len(few)] == few
    assert other[0] != few[0]
    assert len(many) == 16 * (4 if more else 1)
    gravity = [sample["fluid.gravity.1"] for sample in many]
    assert -20.0 <= min(gravity) < -17.0 < -13.0 < max(gravity) <= -10.0


@pytest.mark.long
def test_first_order_indices_of_a_free_fall_are_the_exact_ones(tmp_path: Path) -> None:
    """z = z0 + v t - g t²/2 is a sum, so that each part of the variance is that of a term, first-order and total."""
    path = falling_study(tmp_path, random_table(32, GRAVITY, SPEED, HEIGHT, more="indices = true\nseed = 1"))
    result = command(path)
    assert result.exit_code == 0, result.stderr
    variance = np.array([(TIME**2 / 2 * 10.0) ** 2 / 12, (TIME * 2.0) ** 2 / 12, 0.2**2])
    found = rows(tmp_path / "out" / "indices.csv")
    assert [row["parameter"] for row in found] == ["fluid.gravity.1", "body.0.velocity.1", "body.0.position.1"]
    for row, exact in zip(found, variance / variance.sum(), strict=True):
        for name in ("first", "total"):
            half = float(row[f"{name}_confidence"])
            assert 0.0 < half < 0.5
            assert abs(float(row[name]) - exact) < half
    assert [float(row["total"]) for row in found] == pytest.approx(list(variance / variance.sum()), abs=0.06)
    assert "fluid.gravity.1: first-order Sobol index 0." in result.stdout
    (quantiles,) = rows(tmp_path / "out" / "quantiles.csv")
    assert quantiles["complete"] == quantiles["runs"] == str(32 * 5)
    figures = [float(row["figure"]) for row in rows(tmp_path / "out" / "study.csv")]
    for part in (0.05, 0.5, 0.95):
        assert float(quantiles[f"quantile_{part:g}"]) == pytest.approx(np.quantile(figures, part), rel=1e-12)
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert page.count("<h2>Quantiles</h2>") == page.count("<h2>Sobol indices") == 1


@pytest.mark.usefixtures("product")
def test_total_indices_hold_what_parameters_do_together(tmp_path: Path) -> None:
    """Of a product x y with means m and variances V: first order V_x m_y², together V_x V_y."""
    speed = SPEED.replace("low = -1.0, high = 1.0", "low = 0.0, high = 2.0")
    path = falling_study(tmp_path, random_table(1024, DENSITY, speed, more="indices = true"))
    (one,) = results_of(path).samples
    mean, square = 3.0 / np.log(4.0), 15.0 / 2 / np.log(4.0)
    of_density, of_speed, both = square - mean**2, mean**2 / 3, (square - mean**2) / 3
    whole = of_density + of_speed + both
    density, speed_index = one.indices.values()
    assert density.first == pytest.approx(of_density / whole, abs=0.02)
    assert density.total == pytest.approx((of_density + both) / whole, abs=0.02)
    assert speed_index.first == pytest.approx(of_speed / whole, abs=0.02)
    assert speed_index.total == pytest.approx((of_speed + both) / whole, abs=0.02)


def test_a_sample_with_a_failed_run_is_left_out_of_the_indices() -> None:
    rng = np.random.default_rng(0)
    blocks = rng.random((32, 4))
    damaged = np.vstack([blocks, [[1e3, np.nan, 1e3, 1e3]]])
    assert sobol_indices(damaged.ravel(), 2, 0) == sobol_indices(blocks.ravel(), 2, 0)
    assert sobol_indices(damaged[31:].ravel(), 2, 0) == []


@pytest.mark.parametrize("figures", [np.full(16, 3.0), 3.0 * (1 + 1e-15 * np.arange(16))])
def test_a_figure_that_does_not_vary_has_no_indices(figures: Any) -> None:
    assert sobol_indices(figures, 2, 0) == []


def test_quantiles_with_each_numerical_setting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run(self: SceneSubject, settings: dict[str, Any], _: object) -> Outcome:
        return Outcome(settings["fluid.gravity.1"] + settings["time.step"], 0.1, 0, round(1.0 / settings["time.step"]))

    monkeypatch.setattr(SceneSubject, "run", run)
    tables = random_table(3, GRAVITY) + "[vary]\ntime.step = [0.25, 0.125]\n"
    results = results_of(falling_study(tmp_path, tables, error='reference = "finest"'))
    assert len(results.groups) == 3
    assert list(results.errors.values()) == pytest.approx([0.125, 0.0] * 3)
    found = rows(tmp_path / "out" / "quantiles.csv")
    assert [(row["time.step"], row["runs"]) for row in found] == [("0.25", "3"), ("0.125", "3")]
    assert float(found[0]["quantile_0.5"]) - float(found[1]["quantile_0.5"]) == pytest.approx(0.125)
    assert not (tmp_path / "out" / "indices.csv").exists()


def test_samples_that_fail_are_counted(tmp_path: Path) -> None:
    density = 'body.0.density = { distribution = "uniform", low = -1.0, high = 1.0 }\n'
    result = command(falling_study(tmp_path, random_table(8, density)))
    assert result.exit_code == 0, result.stderr
    found = rows(tmp_path / "out" / "study.csv")
    refused = [row for row in found if float(row["body.0.density"]) <= 0.0]
    assert 0 < len(refused) < 8
    assert all("body.0.density" in row["message"] for row in refused)
    (quantiles,) = rows(tmp_path / "out" / "quantiles.csv")
    assert int(quantiles["complete"]) == 8 - len(refused)


@pytest.mark.usefixtures("product")
def test_no_table_of_an_earlier_study_stays(tmp_path: Path) -> None:
    results_of(falling_study(tmp_path, random_table(8, DENSITY, SPEED, more="indices = true")))
    (tmp_path / "out" / "notes.csv").write_text("mine")
    results_of(falling_study(tmp_path, random_table(8, DENSITY, SPEED)))
    found = {path.name for path in (tmp_path / "out").iterdir()}
    names = {f"study.{kind}" for kind in ("csv", "html", "lock", "png", "svg")}
    assert found == names | {"quantiles.csv", "notes.csv"}


@pytest.mark.usefixtures("product")
def test_the_plot_shows_samples_quantiles_and_indices(tmp_path: Path) -> None:
    path = falling_study(tmp_path, random_table(8, DENSITY, SPEED, more="indices = true"))
    results = results_of(path)
    samples = results.samples
    density, speed, bars = samples_plot(results, samples).axes
    assert [axes.get_xlabel() for axes in (density, speed)] == ["body.0.density", "body.0.velocity.1"]
    points, median = density.lines
    assert points.get_ydata() == pytest.approx(samples[0].figures)
    assert points.get_xdata() == pytest.approx([group["body.0.density"] for group in results.study.groups])
    assert median.get_ydata() == pytest.approx([samples[0].quantiles[1]] * 2)
    first, total = bars.containers[1], bars.containers[3]
    assert [bar.get_height() for bar in first] == [index.first for index in samples[0].indices.values()]
    assert [bar.get_height() for bar in total] == [index.total for index in samples[0].indices.values()]


@pytest.mark.parametrize(
    ("tables", "texts"),
    [
        (random_table(8, GRAVITY.replace("-20.0", "-5.0")), ("random.parameters.fluid.gravity.1", "low below high")),
        (random_table(8, DENSITY.replace("low = 1.0", "low = 0.0")), ("density.low", "0.0", "greater than 0")),
        (random_table(8, HEIGHT.replace("0.2", "0.0")), ("position.1.deviation", "greater than 0")),
        (random_table(8, HEIGHT.replace("5.0", "'high'")), ("position.1.mean", "'high'", "a valid number")),
        (random_table(8, HEIGHT.replace('"normal"', '"norml"')), ("distribution", "'norml'", "Did you mean 'normal'?")),
        (
            random_table(8, HEIGHT.replace('distribution = "normal", ', "")),
            ("distribution: found nothing", "'uniform'"),
        ),
        (random_table(8, "fluid.gravity.1 = [1.0]\n"), ("random.parameters.fluid.gravity.1", "[1.0]")),
        (random_table(8, DENSITY.replace("density", "densty")), ("body.0.densty", "Did you mean 'density'?")),
        (random_table(1, DENSITY), ("random.number", "1", "greater than or equal to 2")),
        (random_table(8), ("random.parameters", "at least 1 entry")),
        (random_table(20000, DENSITY), ("random", "20000 runs", "at most 10000", "fewer samples")),
        (random_table(4096, DENSITY, more="indices = true"), ("random", "12288 runs", "at most 10000")),
        (random_table(100, DENSITY, more="indices = true"), ("random.number", "100", "a power of 2", "64 or 128")),
        (random_table(8, DENSITY) + "[parameters]\nfluid.gravity.1 = [1.0]\n", ("random", "nothing with [parameters]")),
    ],
)
def test_wrong_samples(tables: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    check_refusal(command(falling_study(tmp_path, tables)), *texts)


def test_indices_without_salib(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "SALib", None)
    with pytest.raises(SceneError, match=r"random\.indices: .*pip install 'rigidfluid\[sweeps\]'"):
        load_study(falling_study(tmp_path, random_table(8, DENSITY, more="indices = true")))
    assert len(load_study(falling_study(tmp_path, random_table(8, DENSITY))).groups) == 8
