"""Studies of scenes without a fluid: what is run, what is written, and how they fail."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from falling import SCENES
from falling_study import check_refusal
from typer.testing import CliRunner, Result

import rigidfluid
from rigidfluid.cli import app
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import columns
from rigidfluid.core.output.results_folder import take_folder
from rigidfluid.core.run.summary import FIGURES
from rigidfluid.core.scene.scene import Scene
from rigidfluid.errors import OutputError, SceneError, StepError
from rigidfluid.post.progress import RunsProgress
from rigidfluid.post.reports.style import PALETTE
from rigidfluid.post.studies import load_study, run_study, scene_subject
from rigidfluid.post.studies.distributions import LogUniform, Normal, Uniform
from rigidfluid.post.studies.figure import check_figure, read_figure
from rigidfluid.post.studies.kernel_subject import KernelSubject
from rigidfluid.post.studies.model import ErrorTable, FigureTable, StudyFile, StudyTable
from rigidfluid.post.studies.plot import error_plot
from rigidfluid.post.studies.results import Results, most_expensive, pareto_front
from rigidfluid.post.studies.rows import short_text
from rigidfluid.post.studies.run import STUDY as FILES
from rigidfluid.post.studies.samples import RandomTable
from rigidfluid.post.studies.scene_subject import SceneSubject
from rigidfluid.post.studies.strict_table import Settings
from rigidfluid.post.studies.subject import Outcome
from rigidfluid.post.studies.table import read_rows
from rigidfluid.registry import FLUID_BACKEND, Registry

HEIGHT_WITHOUT_GRAVITY = 0.5
STUDY = f"""
[study]
name = "bounce"
scene = "{SCENES}/dry_bounce.toml"
label = "height of the left disk"
group = "body.0.density"

[set]
time.end = 0.004
fluid.gravity = [0.0, -100.0]
contact = {{ range = 0.25, epsilon = 1e-5, substeps = 1 }}

[vary]
time.step = [0.002, 0.001, 0.0005]
body.0.density = [1.0, 2.0]

[error]
figure = {{ table = "bodies", column = "y", body = "left_disk", at = 0.004 }}
reference = 0.5
"""
OTHER_BACKENDS = """
    from rigidfluid.backends.dry import Dry
    from rigidfluid.hookspecs import hookimpl

    class Drier(Dry):
        name = "drier"

    class Missing(Dry):
        name = "missing"
        requires = {"no_such_package": "no-such-package"}

    @hookimpl
    def rigidfluid_fluid_backends():
        return [Drier, Missing]
"""
Write = Callable[..., Path]
Install = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes the study, each ``old`` text replaced by the next."""

    def write(*changes: str) -> Path:
        text = STUDY
        for old, new in zip(changes[::2], changes[1::2], strict=True):
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "bounce.toml"
        path.write_text(text)
        return path

    return write


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[Settings]:
    """The settings of every run that is started."""
    started: list[Settings] = []
    original = SceneSubject.run

    def run(self: SceneSubject, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        started.append(settings)
        return original(self, settings, progress)

    monkeypatch.setattr(SceneSubject, "run", run)
    return started


def study_command(*arguments: object, **environment: str) -> Result:
    return CliRunner().invoke(app, ["study", *map(str, arguments)], env={"COLUMNS": "200"} | environment)


def table(out: Path) -> list[dict[str, str]]:
    with (out / "study.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def results_of(path: Path, out: Path) -> Results:
    return run_study(load_study(path), out)[0]


def refused(path: Path, *texts: str) -> None:
    check_refusal(study_command(path, "--out", path.parent / "out"), *texts)
    assert not (path.parent / "out" / "study.html").exists()


def test_a_row_for_each_combination(write: Write, tmp_path: Path) -> None:
    result = study_command(write(), "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    rows = table(tmp_path / "out")
    knobs = [(row["time.step"], row["body.0.density"]) for row in rows]
    assert knobs == [(step, density) for step in ("0.002", "0.001", "0.0005") for density in ("1.0", "2.0")]
    assert [row["steps"] for row in rows] == ["2", "2", "4", "4", "8", "8"]
    assert {row["status"] for row in rows} == {"complete"}
    for row in rows:
        assert float(row["error"]) == abs(float(row["figure"]) - HEIGHT_WITHOUT_GRAVITY)
        assert float(row["seconds"]) > 0
    assert "6 runs, 0 failed; reference 0.5" in result.stdout
    assert "on the Pareto front" in result.stdout


@pytest.mark.parametrize(("seconds", "name"), [("wall", "wall_time"), ("cpu", "cpu_time")])
def test_seconds_are_by_the_clock_that_is_asked_for(
    seconds: str, name: str, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write('group = "body.0.density"', f'zip = true\nseconds = "{seconds}"', "0.001, 0.0005]", "0.001]")
    subject = SceneSubject(study := load_study(path))
    history = rigidfluid.run(scene_from_dict(subject._tables(study.settings()[0])))
    assert history.summary["cpu_time"] > 0.0
    history.summary |= {"wall_time": 7.0, "cpu_time": 5.0}
    monkeypatch.setattr("rigidfluid.post.studies.scene_subject.simulate", lambda *_, **__: history)
    assert subject.run(study.settings()[0], lambda _: None).seconds == history.summary[name]


def test_lists_side_by_side(write: Write) -> None:
    path = write('group = "body.0.density"', "zip = true", "0.001, 0.0005]", "0.001]")
    expected = [{"time.step": 0.002, "body.0.density": 1.0}, {"time.step": 0.001, "body.0.density": 2.0}]
    assert load_study(path).settings() == expected


def test_the_page_needs_no_other_file(write: Write, tmp_path: Path) -> None:
    _, written = run_study(load_study(write()), tmp_path / "out")
    assert [path.name for path in written] == ["study.csv", "study.png", "study.svg", "study.html"]
    page = written[-1].read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 1
    assert 'src="' not in page.replace('src="data:', "")
    for text in ("body.0.density = [1.0, 2.0]", "name = &quot;dry_bounce&quot;", "numpy", "Pareto front"):
        assert text in page
    plot = written[2].read_text(encoding="utf-8")
    for text in ("density 1.0", "density 2.0", "Pareto front", "CPU time [s]", "error of height of the left disk"):
        assert f"<!-- {text} -->" in plot


def test_a_label_is_no_formula(write: Write, tmp_path: Path) -> None:
    _, written = run_study(load_study(write("height of the left disk", r"$\\frac$ of it")), tmp_path / "out")
    assert r"<!-- error of $\frac$ of it -->" in written[2].read_text(encoding="utf-8")


def test_colours_by_one_key_and_markers_by_another(write: Write, tmp_path: Path) -> None:
    path = write('group = "body.0.density"', 'group = ["body.0.density", "time.step"]')
    figure = error_plot(results_of(path, tmp_path / "out"))
    lines = [line for line in figure.axes[0].lines if line.get_linewidth() == 1.0]
    looks = [(line.get_color(), line.get_marker()) for line in lines]
    assert looks == [(colour, marker) for marker in "osD" for colour in PALETTE[:2]]
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["density 1.0", "density 2.0", "step 0.002", "step 0.001", "step 0.0005", "Pareto front"]


def test_each_backend_is_warmed_up_once(
    write: Write, tmp_path: Path, install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(OTHER_BACKENDS, name="others", module="others_for_studies")
    path = write("body.0.density = [1.0, 2.0]", 'fluid.backend = ["dry", "drier"]', "body.0.density", "fluid.backend")
    started: list[tuple[str, float]] = []

    def noted(scene: Scene, **keywords: Any) -> History:
        started.append((scene.fluid.backend, scene.time.end))
        return rigidfluid.run(scene, **keywords)

    monkeypatch.setattr(scene_subject, "simulate", noted)
    results_of(path, tmp_path / "out")
    assert started[:4] == [("dry", 0.002), ("dry", 0.004), ("drier", 0.002), ("drier", 0.004)]
    assert started[4:] == [(name, 0.004) for name in ("dry", "drier")] * 2


def test_backends_that_are_not_there_are_failed_rows(write: Write, tmp_path: Path, install: Install) -> None:
    install(OTHER_BACKENDS, name="others", module="others_for_studies")
    backends = 'fluid.backend = ["dry", "missing", "no_such"]'
    path = write("body.0.density = [1.0, 2.0]", backends, "body.0.density", "fluid.backend", "0.001, 0.0005]", "0.001]")
    assert study_command(path, "--out", tmp_path / "out").exit_code == 0
    rows = table(tmp_path / "out")
    assert [row["status"] for row in rows] == ["complete", "failed", "failed"] * 2
    assert "'missing', which is not usable here" in rows[1]["message"]
    assert "install no-such-package" in rows[1]["message"]
    assert "found 'no_such'" in rows[2]["message"]


def test_errors_against_the_finest_run(write: Write, tmp_path: Path) -> None:
    results = results_of(write("reference = 0.5", 'reference = "finest"\nrelative = true'), tmp_path / "out")
    (finest,) = set(results.finest.values())
    assert results.outcomes[finest].steps == 8
    assert results.errors[finest] == 0
    assert finest not in results.points
    reference = results.outcomes[finest].figure
    first = results.prints[0]
    assert results.errors[first] == pytest.approx(abs(results.outcomes[first].figure / reference - 1), rel=1e-9)
    assert results.errors[first] > 1e-5


def test_a_stopped_study_goes_on(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ran: list[Any]) -> None:
    path, counted = write(), SceneSubject.run

    def stopped(self: SceneSubject, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        if len(ran) == 2:
            raise KeyboardInterrupt
        return counted(self, settings, progress)

    with monkeypatch.context() as patch:
        patch.setattr(SceneSubject, "run", stopped)
        result = study_command(path, "--out", tmp_path / "out")
    assert result.exit_code == 130
    assert "goes on" in result.stderr
    before = table(tmp_path / "out")
    assert len(before) == 2
    assert study_command(path, "--out", tmp_path / "out").exit_code == 0
    assert ran == load_study(path).settings()
    assert table(tmp_path / "out")[:2] == before


def test_only_new_settings_are_run(write: Write, tmp_path: Path, ran: list[Any]) -> None:
    run_study(load_study(write()), tmp_path / "out")
    ran.clear()
    more = write("time.step = [0.002,", "time.step = [0.004, 0.002,", "reference = 0.5", "reference = 0.4")
    run_study(load_study(more), tmp_path / "out")
    assert ran == [{"time.step": 0.004, "body.0.density": density} for density in (1.0, 2.0)]
    rows = table(tmp_path / "out")
    assert len(rows) == 8
    assert all(float(row["error"]) == abs(float(row["figure"]) - 0.4) for row in rows)


@pytest.mark.parametrize("change", [("-100.0", "-50.0"), ('column = "y"', 'column = "x"')])
def test_other_scenes_and_figures_are_run_anew(
    change: tuple[str, str], write: Write, tmp_path: Path, ran: list[Any]
) -> None:
    run_study(load_study(write()), tmp_path / "out")
    run_study(load_study(write(*change)), tmp_path / "out")
    assert len(ran) == 12


def test_fresh_runs_everything(write: Write, tmp_path: Path, ran: list[Any]) -> None:
    path = write("0.001, 0.0005]", "0.001]")
    for option in ("--resume", "--fresh"):
        assert study_command(path, "--out", tmp_path / "out", option).exit_code == 0
    assert len(ran) == 8


def test_a_failing_run_stops_nothing(write: Write, tmp_path: Path, ran: list[Any]) -> None:
    path = write("[0.002, 0.001, 0.0005]", "[-1.0, 0.002]")
    result = study_command(path, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    assert "4 runs, 2 failed" in result.stdout
    rows = table(tmp_path / "out")
    assert [row["status"] for row in rows] == ["failed", "failed", "complete", "complete"]
    assert all("time.step: found -1.0; allowed is a value greater than 0" in row["message"] for row in rows[:2])
    page = (tmp_path / "out" / "study.html").read_text(encoding="utf-8")
    assert "2 of 4 runs failed" in page
    assert "failed: time.step: found -1.0" in page
    assert study_command(path, "--out", tmp_path / "out").exit_code == 0
    assert len(ran) == 4


def test_runs_without_an_error_to_draw(write: Write, tmp_path: Path) -> None:
    path = write("[0.002, 0.001, 0.0005]", "[0.002]", "[1.0, 2.0]", "[1.0]", "reference = 0.5", 'reference = "finest"')
    _, written = run_study(load_study(path), tmp_path / "out")
    assert [file.name for file in written] == ["study.csv", "study.html"]
    assert "No run has an error to draw" in written[-1].read_text(encoding="utf-8")


def test_progress_grows_to_the_number_of_runs(write: Write, tmp_path: Path) -> None:
    seen: list[RunsProgress] = []
    run_study(load_study(write()), tmp_path / "out", progress=seen.append)
    done = [now.done for now in seen]
    assert done == sorted(done)
    assert (done[0], done[-1]) == (0, 6)
    assert 0.5 in done
    assert {now.total for now in seen} == {6}
    assert seen[0].about == "time.step 0.002, body.0.density 1.0"


def test_a_terminal_shows_a_bar(write: Write, tmp_path: Path) -> None:
    result = study_command(write(), "--out", tmp_path / "out", FORCE_COLOR="1")
    assert result.exit_code == 0, result.exception
    assert "run 6 of 6: time.step 0.0005, body.0.density 2.0" in result.stderr


@pytest.mark.parametrize(
    ("old", "new", "texts"),
    [
        ("[study]", "[stady]", ("stady", "a key that nothing reads", "Did you mean 'study'?")),
        ('label = "', 'lable = "', ("study.lable", "Did you mean 'label'?")),
        (
            "time.step = [0.002, 0.001, 0.0005]",
            "time.step = 0.002",
            ("vary.time.step", "0.002", "a list", "in brackets: [0.002]"),
        ),
        ("time.step = [0.002, 0.001, 0.0005]", "time.step = []", ("vary.time.step", "[]", "at least 1 entry")),
        ("time.step =", "time.stop =", ("time.stop", "a key that nothing reads", "Did you mean 'step'?")),
        ("body.0.density", "body.7.density", ("body.7.density", "'7' in a list", "a number from 0 to 1")),
        ("-100.0]", "-100.0, 0.0]", ("fluid.gravity", "-100.0")),
        ('group = "body.0.density"', 'group = "time.stop"', ("study.group", "Did you mean 'time.step'?")),
        ('group = "body.0.density"', 'group = ["time.stop"]', ("study.group", "Did you mean 'time.step'?")),
        ('group = "body.0.density"', 'group = ["a", "b", "c"]', ("study.group", "at most 2 entries")),
        ('group = "body.0.density"', "zip = true", ("vary", "3 values of time.step, 2 values of body.0.density")),
        ("dry_bounce.toml", "dry_bonce.toml", ("dry_bonce.toml", "No such file", "a readable scene file")),
        ('column = "y"', 'column = "yy"', ("error.figure.column", "'yy'", "Did you mean 'y'?")),
        ('"left_disk"', '"left_dish"', ("error.figure.body", "'left_dish'", "Did you mean 'left_disk'?")),
        ("at = 0.004", "at = 0.005", ("error.figure.at", "0.005", "time.end, 0.004")),
        ("at = 0.004", 'at = 0.004, extreme = "lowest"', ("error.figure", "one of at and extreme")),
        ('table = "bodies"', 'table = "energy"', ("error.figure", "body with table bodies or contacts")),
        ('table = "bodies"', 'table = "contacts"', ("error.figure", "extreme with table contacts")),
        ('body = "left_disk"', "probe = 0", ("error.figure", "probe with table probes")),
        ("at = 0.004", 'at = 0.004, key = "time"', ("error.figure", "a key path of summary.json, or")),
        ("reference = 0.5", 'reference = "best"', ("error.reference", "'best'", "a valid number", "finest")),
        ("reference = 0.5", "reference = 0\nrelative = true", ("error.reference", "Set relative = false")),
        ('group = "body.0.density"', 'seconds = "cup"', ("study.seconds", "'cup'", "'wall' or 'cpu'")),
        ("reference = 0.5", "", ("error.reference", "nothing", "Add the key 'reference'")),
        ("[vary]", "[vary", ("bounce.toml", "invalid TOML", "Mend the file")),
        ("[0.002, 0.001, 0.0005]", str([0.001] * 5001), ("vary", "10002 runs", "at most 10000")),
    ],
)
def test_wrong_study_files(old: str, new: str, texts: tuple[str, ...], write: Write) -> None:
    refused(write(old, new), *texts)


@pytest.mark.parametrize(("key", "near"), [("reynods", "reynolds"), ("energi.kinetic", "energy")])
def test_unknown_key_of_the_summary(key: str, near: str, write: Write) -> None:
    figure = STUDY[STUDY.index("figure = ") :].partition("\n")[0]
    refused(write(figure, f'figure = "{key}"'), "error.figure", f"Did you mean '{near}'?")


def test_missing_study_file(tmp_path: Path) -> None:
    refused(tmp_path / "none.toml", "none.toml", "No such file", "a readable study file")


def test_a_table_that_is_none(write: Write, tmp_path: Path) -> None:
    take_folder(tmp_path, FILES, new=True).close()
    (tmp_path / "study.csv").write_text("identity,status\n1234,complete\n")
    with pytest.raises(OutputError, match=r"study\.csv.*Use --fresh"):
        run_study(load_study(write()), tmp_path)


def test_rows_are_read_back_bit_for_bit(write: Write, tmp_path: Path) -> None:
    results = results_of(write(), tmp_path)
    assert read_rows(tmp_path / "study.csv") == results.rows


def test_pareto_front() -> None:
    points = {"slow": (8.0, 1.0), "good": (4.0, 0.5), "fast": (1.0, 2.0), "bad": (2.0, 3.0), "late": (9.0, 0.5)}
    assert pareto_front(points) == ["fast", "good"]
    assert pareto_front({"a": (1.0, 1.0), "b": (1.0, 1.0), "c": (1.0, 2.0)}) == ["a", "b"]
    assert pareto_front({}) == []
    nearly = {"fast": (1.0, 1.0), "round-off": (2.0, 1.0 - 1e-12), "better": (3.0, 0.999)}
    assert pareto_front(nearly) == ["fast", "better"]


def test_most_expensive_run() -> None:
    runs = {"long": Outcome(1, 9.0, 10, 10), "large": Outcome(1, 1.0, 101, 1), "fine": Outcome(1, 1.0, 10, 20)}
    assert most_expensive(runs) == "fine"
    assert most_expensive({"a": Outcome(1, 1.0, 0, 5), "b": Outcome(1, 2.0, 0, 4)}) == "a"


def rows_of(table: str, time: float) -> list[Any]:
    """Rows of one step: kinetic energy t², pressure of probe p (p + 1)t, contacts disk–floor and disk–ball, flux t at
    the left and 2t at the back, content 3t of a scalar."""
    values: list[dict[str, Any]] = {
        "energy": [{"kinetic": time**2}],
        "probes": [{"probe": probe, "pressure": (probe + 1) * time} for probe in (0, 1)],
        "contacts": [{"a": "disk", "b": b, "gap": time + gap} for b, gap in (("floor", 0.1), ("ball", 0.2))],
        "driving": [{"surface": name, "flux": factor * time} for name, factor in (("left", 1), ("back", 2))],
        "scalar": [{"content": 3 * time}],
        "scalar_fluxes": [{"surface": name, "value": factor * time} for name, factor in (("disk", 4), ("left", 5))],
    }[table]
    names = columns(2)[table]
    return [tuple({"time": time, **row}.get(name, 0.0) for name in names) for row in values]


@pytest.fixture
def history() -> History:
    """One body, whose x is the cube of the time."""
    history = History(2)
    tables = ("energy", "probes", "contacts", "driving", "scalar", "scalar_fluxes")
    places = columns(2)["bodies"].index
    for step, time in enumerate(np.linspace(0, 1, 6).tolist()):
        row: list[Any] = [0.0] * len(columns(2)["bodies"])
        row[places("time")], row[places("body")], row[places("x")] = time, "disk", time**3 - time
        history.extend({"bodies": [tuple(row)]})
        history.extend({name: rows_of(name, time) for name in tables})
        history.summary = {"steps": step, "rest_position": {"disk": [0.25, 0.75]}, "smallest_gap": None}
    return history


@pytest.mark.parametrize(
    ("figure", "expected"),
    [
        ({"table": "bodies", "column": "x", "at": 0.4}, 0.4**3 - 0.4),
        ({"table": "bodies", "column": "x", "at": 0.47}, 0.47**3 - 0.47),
        ({"table": "bodies", "column": "x", "extreme": "lowest"}, 0.6**3 - 0.6),
        ({"table": "bodies", "column": "x", "body": "disk", "extreme": "highest"}, 0.0),
        ("rest_position.disk.1", 0.75),
        ("steps", 5),
        ({"table": "energy", "column": "kinetic", "at": 0.5}, 0.25),
        ({"table": "energy", "column": "kinetic", "extreme": "highest"}, 1.0),
        ({"table": "probes", "column": "pressure", "extreme": "highest"}, 1.0),
        ({"table": "probes", "column": "pressure", "probe": 1, "at": 0.5}, 1.0),
        ({"table": "contacts", "column": "gap", "extreme": "lowest"}, 0.1),
        ({"table": "contacts", "column": "gap", "body": "ball", "extreme": "lowest"}, 0.2),
        ({"table": "contacts", "column": "gap", "body": "disk", "extreme": "highest"}, 1.2),
        ({"table": "driving", "column": "flux", "at": 0.5}, 0.5),
        ({"table": "driving", "column": "flux", "surface": "back", "at": 0.5}, 1.0),
        ({"table": "scalar", "column": "content", "extreme": "highest"}, 3.0),
        ({"table": "scalar_fluxes", "column": "value", "surface": "left", "extreme": "highest"}, 5.0),
    ],
)
def test_figures(figure: Any, expected: float, history: History) -> None:
    assert read_figure(FigureTable.model_validate(figure), history) == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(
    ("figure", "text"),
    [
        ({"table": "energy", "column": "kinetik", "extreme": "lowest"}, "Did you mean 'kinetic'"),
        ({"table": "contacts", "column": "a", "extreme": "lowest"}, "error.figure.column: found 'a'"),
        ({"table": "probes", "column": "pressure", "extreme": "lowest"}, "error.figure.probe: found 0.*of 0 probes"),
        ({"table": "driving", "column": "flux", "at": 0.0}, "error.figure.table: found 'driving'.*periodic surfaces"),
        ({"table": "scalar", "column": "rate", "at": 0.0}, r"error.figure.table: found 'scalar'.*with .scalar."),
    ],
)
def test_figures_that_a_scene_will_not_have(figure: Any, text: str) -> None:
    scene = rigidfluid.load_scene(SCENES / "dry_bounce.toml")
    with pytest.raises(SceneError, match=text):
        check_figure(FigureTable.model_validate(figure), scene)


@pytest.mark.parametrize(
    ("shipped", "table", "column", "known"),
    [("periodic_channel", "driving", "flux", "left"), ("hot_cavity", "scalar_fluxes", "value", "right")],
)
def test_surfaces_of_fluxes_are_known_before_anything_runs(shipped: str, table: Any, column: str, known: str) -> None:
    scene = rigidfluid.load_scene(SCENES / f"{shipped}.toml")
    figure = FigureTable(table=table, column=column, surface=known, extreme="highest")
    check_figure(figure, scene)
    with pytest.raises(SceneError, match=rf"error\.figure\.surface: found '{known}s'.*Did you mean '{known}'"):
        check_figure(figure.model_copy(update={"surface": f"{known}s"}), scene)


@pytest.mark.parametrize("table", ["driving", "scalar", "scalar_fluxes"])
def test_tables_that_a_run_leaves_empty_are_no_figure(table: Any) -> None:
    column = {"driving": "flux", "scalar": "content", "scalar_fluxes": "value"}[table]
    with pytest.raises(SceneError, match=rf"nan for {column} at 0\.5"):
        read_figure(FigureTable(table=table, column=column, at=0.5), History(2))


def test_a_surface_is_of_a_table_of_fluxes() -> None:
    with pytest.raises(ValueError, match="surface with table driving or scalar_fluxes"):
        FigureTable(table="energy", column="kinetic", surface="left", at=0.5)


def test_contacts_that_never_come_are_no_figure() -> None:
    figure = FigureTable(table="contacts", column="gap", extreme="lowest")
    with pytest.raises(SceneError, match="nan for gap lowest"):
        read_figure(figure, History(2))


@pytest.mark.parametrize(
    ("key", "text"), [("smallest_gap", "None for smallest_gap"), ("rest_position.dish", "Did you mean 'disk'?")]
)
def test_figures_that_a_run_lacks(key: str, text: str, history: History) -> None:
    with pytest.raises(SceneError, match=text.replace("?", r"\?")):
        read_figure(FigureTable(key=key), history)


def test_the_error_of_the_mesh_is_a_figure_where_it_is_estimated() -> None:
    figure, shipped = FigureTable(key="mesh_error.largest"), SCENES / "falling_disk.toml"
    check_figure(figure, rigidfluid.load_scene(shipped, ["mesh.estimate=true"]))
    with pytest.raises(SceneError, match=r"error\.figure: found 'mesh_error'"):
        check_figure(figure, rigidfluid.load_scene(shipped))


def test_figures_are_keys_of_the_summary() -> None:
    summary = rigidfluid.run(rigidfluid.load_scene(SCENES / "dry_bounce.toml", ["time.end=2e-5"])).summary
    of_few_scenes = {"cycles", "mesh_error", "error_estimates", "exchanges"}
    assert set(FIGURES) - of_few_scenes == {key for key, value in summary.items() if not isinstance(value, str)} - {
        "scene", "seed", "versions", "files", "auto_epsilon", "peak_memory", "latest_failed_remesh", "remarks"
    }  # fmt: skip


@pytest.mark.parametrize("path", sorted((SCENES.parent / "studies").glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_studies_can_be_run(path: Path) -> None:
    study = load_study(path)
    if study.scene is None:
        kernels = KernelSubject(study)
        assert [kernels.read(settings) for settings in study.settings()]
        return
    subject = SceneSubject(study)
    identities = {subject.identity(settings) for settings in study.settings()}
    assert len(identities) == len(study.settings())
    usable = {entry.name for entry in Registry.load().entries if entry.kind is FLUID_BACKEND and entry.available}
    for identity in identities:
        tables = json.loads(identity)[0]
        if tables["fluid"].get("backend", "scikit-fem") in usable:
            scene_from_dict(tables)


def test_tables_are_named_by_what_differs() -> None:
    tables = [{"law": "centre", "range": 0.1}, {"law": "centre", "range": 0.1, "substeps": 1}, {"law": "normal"}]
    assert short_text(tables[1], tables) == "law centre, range 0.1, substeps 1"
    assert short_text(tables[1], tables[:2]) == "substeps 1"
    assert short_text(0.5, [0.5, 1.0]) == "0.5"


def test_every_key_of_a_study_is_explained() -> None:
    page = (SCENES.parent / "docs" / "studies.md").read_text(encoding="utf-8")
    keys = [f"study.{key}" for key in StudyTable.model_fields] + [f"error.{key}" for key in ErrorTable.model_fields]
    keys += [f"[{key}]" for key in StudyFile.model_fields if key not in ("study", "error")]
    assert [key for key in keys if f"| `{key}` |" not in page] == []
    assert [key for key in FigureTable.model_fields if key != "key" and key not in page] == []
    assert [key for key in RandomTable.model_fields if key != "parameters" and f"\n{key} = " not in page] == []
    for table in (Uniform, LogUniform, Normal):
        (name,) = get_args(table.model_fields["distribution"].annotation)
        assert f'distribution = "{name}"' in page


def test_the_examples_of_the_page_are_studies(tmp_path: Path) -> None:
    page = (SCENES.parent / "docs" / "studies.md").read_text(encoding="utf-8")
    step, sweep, random = page.replace("../scenes", str(SCENES)).split("```toml\n")[1:4]
    parts = {name: text.partition("```")[0] for name, text in (("step", step), ("sweep", sweep), ("random", random))}
    head, _, rest = parts["sweep"].partition("[parameters]")
    parts["random"] = f"{head}{parts['random']}[vary]{rest.partition('[vary]')[2]}"
    for name, text in parts.items():
        path = tmp_path / f"{name}.toml"
        path.write_text(text)
        SceneSubject(load_study(path))


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (("[error]\n", "[erorr]\n"), "17"),
        (('group = "body.0.density"', 'group = "body.0.mass"'), "6"),
        (("time.end = 0.004", "time.end = -1.0"), "9"),
        (("time.step = [0.002, 0.001, 0.0005]", "time.stepp = [0.002]"), "14"),
        (('body = "left_disk"', 'body = "lefty"'), "18"),
    ],
)
def test_errors_of_a_study_name_its_file_and_line(write: Write, changes: tuple[str, ...], line: str) -> None:
    path = write(*changes)

    told = CliRunner().invoke(app, ["study", str(path), "--out", str(path.parent / "out")])

    assert told.exit_code == 2
    assert f"{path}:{line}: " in told.stderr


def test_errors_of_its_scene_name_the_scene_file(write: Write) -> None:
    path = write(f"{SCENES}/dry_bounce.toml", "broken.toml")
    scene = path.with_name("broken.toml")
    scene.write_text((SCENES / "dry_bounce.toml").read_text().replace("radius = ", "raduis = ", 1))

    told = CliRunner().invoke(app, ["study", str(path), "--out", str(path.parent / "out")])

    assert f"{scene}:" in told.stderr


def test_a_study_all_of_whose_runs_fail_says_why_and_ends_with_an_error(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(self: SceneSubject, settings: Settings, progress: Callable[[float], None]) -> Outcome:
        raise StepError("body left_disk", "a gap of -1", "a positive one", "Soften the law.")

    monkeypatch.setattr(SceneSubject, "run", fail)
    path = write("time.step = [0.002, 0.001, 0.0005]", "time.step = [0.002]")
    out = path.parent / "out"

    told = CliRunner().invoke(app, ["study", str(path), "--out", str(out)])

    assert told.exit_code == 1
    assert "2 runs, 2 failed" in told.stdout
    assert "the first failed run, time.step 0.002, body.0.density 1.0: body left_disk: " in told.stderr
    assert f"{out / 'study.csv'} has the reasons of all." in told.stderr
