"""Comparisons of fluid backends: differences of known histories, what is run, kept and resumed, and how it fails."""

from __future__ import annotations

import json
import math
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from falling import SCENES, falling_disk
from scenes import dry_tables
from typer.testing import CliRunner, Result

import rigidfluid
from rigidfluid.api import Simulation
from rigidfluid.cli import app
from rigidfluid.core.case.system import build_system
from rigidfluid.core.output.records import columns
from rigidfluid.core.scene.scene_text import scene_text
from rigidfluid.errors import RigidfluidError, SceneError
from rigidfluid.post.comparison import child, compare, runs
from rigidfluid.post.comparison.differences import interpolated, pair
from rigidfluid.post.comparison.figures import difference_plot, most_different
from rigidfluid.post.comparison.page import MOST_BODIES
from rigidfluid.post.comparison.scenes import backend_scenes
from rigidfluid.post.comparison.tables import meaning
from rigidfluid.post.progress import RunsProgress
from rigidfluid.post.reports import report
from rigidfluid.post.reports.results import Results

pytestmark = pytest.mark.long

BOUNCE, FALL = SCENES / "dry_bounce.toml", SCENES / "falling_disk.toml"
SHORT = ("time.end=4e-5", "time.step=1e-5", "output.every=1e-5")
PUSH = 0.25
BACKENDS = f"""
    import os, signal
    from dataclasses import replace
    from pathlib import Path

    from pydantic import Field

    from rigidfluid.backends.dry import Dry
    from rigidfluid.backends.scikit_fem import ScikitFem
    from rigidfluid.core.fluid.material import Newtonian
    from rigidfluid.core.model.part import PartOptions
    from rigidfluid.errors import StepError
    from rigidfluid.hookspecs import hookimpl

    class PushOptions(PartOptions):
        push: float = Field({PUSH}, lt=9)

    class Pushed(Dry):
        name = "pushed"
        Options = PushOptions

        def advance(self, fluid, mesh, step):
            made = super().advance(fluid, mesh, step)
            # a negative push is no number
            made.hydrodynamic_wrench.force[-1, 0] = self.options.push if self.options.push > 0 else float("nan")
            return made

    class Failing(Dry):
        name = "failing"

        def advance(self, fluid, mesh, step):
            raise StepError("the step", "a fault", "none", "Mend it.")

    class Faulty(Dry):
        name = "faulty"

        def advance(self, fluid, mesh, step):
            raise ZeroDivisionError("no number")

    class Unexpected(Dry):
        name = "unexpected"

        def __getattribute__(self, name):
            if name == "advance":
                print("what led to it", flush=True)
                raise KeyError("nobody")
            return super().__getattribute__(name)

    class Dying(Dry):
        name = "dying"

        def advance(self, fluid, mesh, step):
            os.kill(os.getpid(), signal.SIGKILL)

    class Missing(Dry):
        name = "missing"
        requires = {{"no_such_package": "no-such-package"}}

    class Thick(ScikitFem):
        name = "thick"

        def __init__(self, options, problem):
            super().__init__(options, replace(problem, material=Newtonian(1.1 * problem.material.dynamic_viscosity)))

    @hookimpl
    def rigidfluid_fluid_backends():
        return [Pushed, Failing, Faulty, Unexpected, Dying, Missing, Thick]
"""
Install = Callable[..., Path]


@pytest.fixture(autouse=True)
def _backends(install: Install) -> None:
    install(BACKENDS, name="backends", module="backends_for_comparison")


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, bool]]:
    """Runs are made in this process; what was started, and whether it was resumed."""
    made: list[tuple[str, bool]] = []

    def run_here(scene: Path, folder: Path, log: Path, *, resume: bool, watch: Callable[[], None]) -> str:
        made.append((folder.name, resume))
        try:
            rigidfluid.run(rigidfluid.load_scene(scene), folder, resume=resume)
        except RigidfluidError as error:
            return str(error)
        finally:
            watch()
        return ""

    monkeypatch.setattr(runs, "run_apart", run_here)
    return made


def compare_command(*arguments: object, columns: int = 200) -> Result:
    return CliRunner().invoke(app, ["compare", *map(str, arguments)], env={"COLUMNS": str(columns)})


def options(*backends: str, settings: tuple[str, ...] = SHORT) -> list[str]:
    words = [word for name in backends for word in ("--backend", name)]
    return words + [word for setting in settings for word in ("--set", setting)]


# Differences of histories that are made by hand.


def history(time: list[float], energy: list[float] | None = None, count: int = 2, **values: Any) -> tuple[str, Results]:
    """A run of ``count`` bodies; columns that are not given are 0, quaternions 1."""
    dimension = 3 if any(name.startswith("q") for name in values) else 2
    body = {"type": "sphere", "radius": 0.1, "density": 1.0}
    scene = rigidfluid.scene_from_dict(
        dry_tables(
            *[body | {"position": [i + 0.5] * dimension} for i in range(count)],
            step=0.1,
            domain={"lower": [0.0] * dimension, "upper": [float(count)] * dimension},
        )
    )
    bodies = {}
    for name in columns(dimension)["bodies"]:
        given = np.array(values.get(name, 1.0 if name == "qw" else 0.0), dtype=float)
        bodies[name] = np.broadcast_to(given, (len(time), count)).copy()
    table = {"kinetic": np.array(energy or [0.0] * len(time)), "contact": np.ones(len(time))}
    return "backend", Results({}, scene, build_system(scene), np.array(time), bodies, table, ())


def test_a_run_does_not_differ_from_itself() -> None:
    random = np.random.default_rng(0)
    turns = random.standard_normal((4, 5, 2))
    turns /= np.linalg.norm(turns, axis=0)
    others = {name: random.standard_normal((5, 2)) for name in ("x", "vy", "wz", "fx")}
    run = history([0.0, 0.1, 0.3, 0.35, 0.4], **dict(zip(("qw", "qx", "qy", "qz"), turns, strict=True)), **others)
    found = pair(run, run)
    assert {name: difference.largest for name, difference in found.differences.items()} == dict.fromkeys(
        ("position", "velocity", "orientation", "spin", "hydrodynamic_force", "energy"), 0.0
    )
    assert not found.interpolated.any()
    assert all(difference.range > 0 for name, difference in found.differences.items() if name != "energy")


def test_known_differences() -> None:
    time = [0.0, 0.1, 0.2, 0.3]
    ramp = np.array([[0.0, 0.0], [0.0, 1.0], [0.0, 2.0], [0.0, 1.0]])
    ours = history(time, x=3 * ramp, y=4 * ramp, vx=ramp, angle=ramp, w=ramp, fy=10 * ramp, energy=[0, 1, 2, 3])
    apart = np.array([[0.0, 0.0], [0.0, 3e-3], [1e-3, 0.0], [2e-3, 1e-3]])
    theirs = history(
        time,
        x=3 * ramp + apart, y=4 * ramp - 4 / 3 * apart, vx=ramp - apart, angle=ramp + apart, w=ramp - 2 * apart,
        fy=10 * ramp + 100 * apart, energy=[0, 1, 2.5, 3.25],
    )  # fmt: skip
    found = pair(ours, theirs).differences
    largest = {name: difference.largest for name, difference in found.items()}
    assert largest == pytest.approx(
        {
            "position": 5e-3, "velocity": 3e-3, "orientation": 3e-3, "spin": 6e-3, "hydrodynamic_force": 0.3,
            "energy": 0.5,
        }
    )  # fmt: skip
    relative = {name: difference.relative for name, difference in found.items()}
    assert relative == pytest.approx(
        {
            "position": 5e-4, "velocity": 1.5e-3, "orientation": 1.5e-3, "spin": 3e-3, "hydrodynamic_force": 0.015,
            "energy": 1 / 6,
        }
    )  # fmt: skip
    assert found["position"].largest_at == (1, 1)
    assert found["position"].final == pytest.approx(5 / 3 * 2e-3)
    assert found["energy"].final == 0.25


def test_no_relative_difference_where_nothing_changes() -> None:
    difference = pair(history([0.0, 1.0], x=1.0), history([0.0, 1.0], x=1.5)).differences["position"]
    assert (difference.largest, difference.relative) == (0.5, None)


def test_other_steps_are_interpolated_within_both_runs() -> None:
    ours = history([0.0, 0.1, 0.2, 0.3, 0.4], x=np.array([[0.0], [1.0], [2.0], [3.0], [4.0]]))
    theirs = history([0.0, 0.2, 0.35], x=np.array([[0.0], [2.5], [4.0]]))
    found = pair(ours, theirs)
    assert found.time.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert found.interpolated.tolist() == [False, True, False, True]
    expected = [0.0, 0.25, 0.5, 0.5]
    np.testing.assert_allclose(found.differences["position"].values, np.transpose([expected] * 2), atol=1e-15)
    assert found.differences["position"].range == 4.0, "of the whole reference"
    assert "at 2 of them backend has no step" in meaning(found)


def test_a_run_that_has_only_begun() -> None:
    begun = history([0.0], x=0.5)
    found = pair(history([0.0, 0.1]), begun)
    assert found.time.tolist() == [0.0]
    assert found.differences["position"].largest == 0.5
    assert pair(begun, history([0.0, 0.1])).differences["position"].final == 0.5


def test_orientations_differ_by_an_angle() -> None:
    half = 0.5 * np.array([[0.0], [0.2], [0.7]])
    ours = history([0.0, 0.1, 0.2], qw=np.cos(half), qy=np.sin(half))
    half = half + 0.15
    theirs = history([0.0, 0.1, 0.2], qw=-np.cos(half), qy=-np.sin(half))
    difference = pair(ours, theirs).differences["orientation"]
    np.testing.assert_allclose(difference.values, 0.3, rtol=1e-12)
    assert difference.range == pytest.approx(0.7)


def test_quaternions_are_interpolated_on_the_short_way() -> None:
    angles = np.array([0.0, 0.4])
    quaternions = np.stack([np.cos(angles / 2), np.sin(angles / 2), 0 * angles, 0 * angles], axis=-1)[:, None]
    quaternions[1] *= -1
    middle = interpolated({"orientation": quaternions}, np.array([0.0, 1.0]), np.array([0.5]))["orientation"][0, 0]
    np.testing.assert_allclose(middle, [math.cos(0.1), math.sin(0.1), 0.0, 0.0], atol=1e-15)


def test_whole_turns_count_in_2d() -> None:
    found = pair(history([0.0, 0.1]), history([0.0, 0.1], angle=2 * math.pi))
    assert found.differences["orientation"].largest == pytest.approx(2 * math.pi)


def test_the_bodies_that_differ_most() -> None:
    ours = history([0.0, 1.0, 2.0], count=4)
    near = history([0.0, 1.0, 2.0], count=4, x=np.array([[0.0] * 4, [0.0, 0.0, 0.5, 0.0], [0.0] * 4]))
    far = history([0.0, 1.0, 2.0], count=4, y=np.array([[0.0] * 4, [0.4, 0.1, 0.0, 0.0], [0.4, 0.0, 0.0, 0.0]]))
    pairs = [pair(ours, near), pair(ours, far)]
    assert most_different(pairs, 1) == [2]
    assert most_different(pairs, 2) == [0, 2]
    assert most_different([pair(ours, ours)], 3) == [0, 1, 2]


def test_differences_of_nothing_are_said_to_be_none() -> None:
    ours = history([0.0, 1.0])
    panels = difference_plot([pair(ours, history([0.0, 1.0], x=np.array([[0.0], [1e-3]])))]).axes
    assert panels[0].get_yscale() == "log"
    assert [text.get_text() for text in panels[1].texts] == ["no difference"]


# Scenes and their options.


def test_each_backend_reads_its_own_keys() -> None:
    settings = ("fluid.push=0.5", "fluid.tolerance=1e-4", "fluid.backend=thick")
    scenes = backend_scenes(BOUNCE, ["dry", "pushed"], settings)
    assert {name: scene.fluid.options for name, scene in scenes.items()} == {"dry": {}, "pushed": {"push": 0.5}}
    assert [scene.fluid.backend for scene in scenes.values()] == ["dry", "pushed"]
    both = backend_scenes(FALL, ["thick", "scikit-fem"], ["fluid.tolerance=1e-4"])
    assert [scene.fluid.options for scene in both.values()] == [{"tolerance": 1e-4}] * 2


@pytest.mark.parametrize(
    ("backends", "setting", "texts"),
    [
        (["pushed"], "", ("--backend", "'pushed' alone", "two or more", "dry, scikit-fem")),
        ([], "", ("--backend", "none", "two or more")),
        (["dry", "dry"], "", ("'dry' twice", "once")),
        (["dry", "pusht"], "", ("'pusht'", "one of", "Did you mean 'pushed'?", "'missing' is not usable", "no-such")),
        (["dry", "missing"], "", ("'missing'", "not usable", "install no-such-package")),
        (["dry", "scikit-fem"], "", ("'dry', which has no fluid", "same problem", "Leave 'dry' out")),
        (["dry", "pushed"], "fluid.puhs=1", ("fluid.puhs with backend 'dry' or 'pushed'", "Did you mean 'push'?")),
        (["dry", "pushed"], "fluid.tolerance=1", ("fluid.tolerance with backend", "nothing reads")),
        (["dry", "pushed"], "fluid.push=9", ("fluid.push with backend 'pushed'", "less than 9")),
        (["dry", "pushed"], "fluid.density=-1", ("Error: fluid.density: ", "greater than 0")),
        (["dry", "pushed"], "fluid=3", ("Error: fluid: ", "3")),
        (["dry", "pushed"], "body.0.raduis=1", ("body.0.raduis", "Did you mean 'radius'?")),
    ],
)
def test_bad_input(backends: list[str], setting: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    settings = (setting,) if setting else ()
    result = compare_command(BOUNCE, *options(*backends, settings=settings), "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: ")
    assert result.stderr.count("\n") == 1
    for text in texts:
        assert text in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", ["dry.toml", "dry.log", "comparison.json", "comparison.html"])
def test_files_that_cannot_be_written(name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(subprocess, "Popen", None)
    if name.startswith("comparison"):
        monkeypatch.setattr(runs, "run_apart", lambda *_, **__: "a fault")
    (tmp_path / name).mkdir()
    result = compare_command(BOUNCE, *options("dry", "pushed"), "--out", tmp_path)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"Error: {tmp_path / name}: ")


def test_scenes_as_text_read_back() -> None:
    import tomllib

    tables = {"a": {"b": [{"c": 1e-16, "d": 'é"\\'}], "e": {"f": {"g": [[1, 2.5], []]}}}, "h": [{"i": True}, {"j": {}}]}
    assert tomllib.loads(scene_text(tables)) == tables


# Runs.


def test_what_a_comparison_writes(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    out, copy = tmp_path / "out", tmp_path / "copy.json"
    result = compare_command(BOUNCE, *options("dry", "pushed"), "--out", out, "--json", copy)
    assert result.exit_code == 0, result.stderr
    assert started == [("dry", False), ("pushed", False)]
    found = json.loads((out / "comparison.json").read_text())
    assert json.loads(copy.read_text()) == found
    assert [run["steps"] for run in found["runs"]] == [4, 4]
    assert found["runs"][0]["versions"].keys() >= {"python", "rigidfluid", "numpy"}
    (only,) = found["pairs"]
    assert (only["reference"], only["backend"], only["times"], only["interpolated"]) == ("dry", "pushed", 5, 0)
    force = only["differences"].pop("hydrodynamic_force")
    assert force["largest"] == force["final"] == PUSH
    assert (force["body"], force["time"], force["relative"]) == ("right_disk", 1e-5, None)
    assert {difference["largest"] for difference in only["differences"].values()} == {0.0}
    assert only["differences"]["energy"]["body"] is None
    for text in (
        "pushed compared with dry",
        "0.25",
        "right_disk",
        "wall time per step [s]",
        "peak memory [MB]",
        "comparison.html",
    ):
        assert text in result.stdout
    assert report(out / "pushed")[-1].name == "report.html"


def test_a_table_for_narrow_terminals(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    result = compare_command(BOUNCE, *options("dry", "pushed"), "--out", tmp_path, columns=80)
    assert result.exit_code == 0, result.stderr
    for word in ("orientation", "length/time", "hydrodynamic", "left_disk"):
        assert word in result.stdout
    assert "…" not in result.stdout


def test_the_page_needs_no_other_file(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    comparison, written = compare(BOUNCE, ["dry", "pushed"], SHORT, tmp_path)
    names = [
        "comparison.json",
        *(f"{name}.{kind}" for name in ("differences", "body_0", "body_1") for kind in ("png", "svg")),
    ]
    assert [path.name for path in written] == [*names, "comparison.html"]
    page = written[-1].read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 3
    assert 'src="' not in page.replace('src="data:', "")
    assert comparison.command.endswith("--backend dry --backend pushed --set time.end=4e-5 --set time.step=1e-5 "
                                       "--set output.every=1e-5")  # fmt: skip
    for text in (comparison.command, "right_disk", "of it: advance [s]", "numpy", "hydrodynamic force", "[[body]]"):
        assert text in page
    plot = written[6].read_text(encoding="utf-8")
    for text in ("dry", "pushed", "position [length]", "velocity [length/time]", "hydrodynamic force [force]"):
        assert f"<!-- {text} -->" in plot


def test_many_bodies_have_few_plots(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    settings = ("fluid.backend=dry", "time.end=0.004", "time.step=0.002")
    comparison, written = compare(SCENES / "hundred_disks.toml", ["dry", "pushed"], settings, tmp_path)
    plots = [path.stem for path in written if path.suffix == ".png"]
    assert len(comparison.bodies) == 100
    assert plots == ["differences", "body_0", "body_1", "body_2", "body_3"]
    assert f"only the {MOST_BODIES} that differ most" in written[-1].read_text(encoding="utf-8")


def test_complete_runs_are_kept(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    def run(*settings: str, fresh: bool = False) -> tuple[bool, int]:
        """Whether the run was kept, and how many were started."""
        started.clear()
        scene = backend_scenes(BOUNCE, ["dry", "pushed"], [*SHORT, *settings])["pushed"]
        made = runs.backend_run("pushed", scene, tmp_path, fresh=fresh)
        assert made.results is not None
        assert made.results.summary["scene"] == scene.to_dict()
        return made.kept, len(started)

    assert run() == (False, 1)
    assert run() == (True, 0)
    assert run("fluid.push=0.5") == (False, 1)
    assert run("fluid.push=0.5") == (True, 0)
    (tmp_path / "pushed" / "bodies.csv").write_text("torn")
    assert run("fluid.push=0.5") == (False, 1)
    assert run("fluid.push=0.5", fresh=True) == (False, 1)


def test_interrupted_runs_are_resumed(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    def taken_up(*settings: str, fresh: bool = False) -> bool:
        """Whether a run that was interrupted is resumed by one with other settings."""
        first, second = (backend_scenes(BOUNCE, ["dry", "pushed"], [*SHORT, *more])["dry"] for more in ((), settings))
        with pytest.raises(KeyboardInterrupt):
            rigidfluid.run(first, tmp_path / "dry", progress=interrupt)
        made = runs.backend_run("dry", second, tmp_path, fresh=fresh)
        assert made.results is not None
        assert not made.kept
        assert made.results.summary["steps"] == 4
        return started[-1][1]

    assert taken_up()
    assert not taken_up("body.0.density=1.5")
    assert not taken_up(fresh=True)


@pytest.mark.parametrize("complete", [True, False])
def test_runs_of_other_bodies_are_neither_kept_nor_resumed(
    complete: bool, started: list[tuple[str, bool]], tmp_path: Path
) -> None:
    scene = backend_scenes(BOUNCE, ["dry", "pushed"], SHORT)["dry"]
    run = Simulation(scene, tmp_path / "dry")
    run.go(2e-5)
    run.remove("left_disk")
    run.go()
    if complete:
        run.finish("complete")
    run.close()
    made = runs.backend_run("dry", scene, tmp_path)
    assert (made.kept, started) == (False, [("dry", False)])


def test_bodies_that_leave_are_not_compared(tmp_path: Path) -> None:
    (tmp_path / "sink.toml").write_text(BOUNCE.read_text() + '\n[[sink]]\non = "bottom"\n')
    with pytest.raises(SceneError, match="sink: found bodies that enter or leave"):
        backend_scenes(tmp_path / "sink.toml", ["dry", "pushed"])


def test_one_failure_leaves_the_others(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    result = compare_command(BOUNCE, *options("failing", "dry", "pushed"), "--out", tmp_path)
    assert result.exit_code == 1
    assert "failing failed: " in result.stderr
    assert "a fault" in result.stderr
    assert "pushed compared with dry" in result.stdout, "the first that is complete is the reference"
    found = json.loads((tmp_path / "comparison.json").read_text())
    assert "a fault" in found["runs"][0]["error"]
    assert [(one["reference"], one["backend"]) for one in found["pairs"]] == [("dry", "pushed")]
    page = (tmp_path / "comparison.html").read_text()
    assert "failing failed: " in page
    assert page.count("data:image/png;base64,") == 3


def test_nothing_to_compare(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    result = compare_command(BOUNCE, *options("dry", "failing"), "--out", tmp_path)
    assert result.exit_code == 1
    assert json.loads((tmp_path / "comparison.json").read_text())["pairs"] == []
    assert "nothing to compare" in (tmp_path / "comparison.html").read_text()


def test_results_that_cannot_be_read_are_a_failure(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(runs, "run_apart", lambda *_, **__: "")
    comparison, _ = compare(BOUNCE, ["dry", "pushed"], SHORT, tmp_path)
    assert all("found no folder; allowed is the folder of a run" in run.error for run in comparison.failed)
    assert len(comparison.failed) == 2


def test_a_run_that_ends_in_no_numbers(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    result = compare_command(BOUNCE, *options("dry", "pushed", settings=(*SHORT, "fluid.push=-1.0")), "--out", tmp_path)
    assert result.exit_code == 1
    found = json.loads((tmp_path / "comparison.json").read_text())
    assert "fluid backend 'pushed', advance at time 0: found force nan" in found["runs"][1]["error"]
    assert found["pairs"] == []


def test_progress(started: list[tuple[str, bool]], tmp_path: Path) -> None:
    shown: list[RunsProgress] = []
    compare(BOUNCE, ["dry", "pushed"], SHORT, tmp_path, progress=shown.append)
    assert [(now.done, now.total, now.about) for now in shown] == [
        (0.0, 2, "dry"), (1.0, 2, "dry"), (1.0, 2, "pushed"), (2.0, 2, "pushed")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "time"),
    [(None, 0.0), ("", 0.0), ("time,step\n", 0.0), ("time,step\n0.5,1\n0.7", 0.5), ("time\n" + "1.5,0\n" * 5000, 1.5)],
)
def test_time_that_a_run_has_reached(text: str | None, time: float, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / "energy.csv").write_text(text)
    assert runs._time_reached(tmp_path) == time


# Processes.


def test_processes_of_their_own(tmp_path: Path) -> None:
    """A failure, an error that nobody expected and a death, with a run that succeeds."""
    backends = ["dry", "failing", "faulty", "unexpected", "dying"]
    comparison, _ = compare(BOUNCE, backends, SHORT, tmp_path)
    assert [run.backend for run in comparison.complete] == ["dry"]
    errors = {run.backend: run.error for run in comparison.failed}
    assert errors["failing"].startswith("the step: found a fault")
    assert errors["faulty"].startswith("fluid backend 'faulty', advance: found ZeroDivisionError: no number")
    assert errors["unexpected"] == "KeyError: 'nobody' (more in unexpected.log)"
    assert "what led to it" in (tmp_path / "unexpected.log").read_text()
    assert errors["dying"] == f"ended by a signal: {signal.strsignal(signal.SIGKILL)}"


def test_the_right_numbers_in_a_fluid(tmp_path: Path) -> None:
    settings = ["mesh.size=0.4", "mesh.size_body=0.08", "time.step=0.01", "time.end=0.03", "output.every=0.01"]
    comparison, _ = compare(FALL, ["scikit-fem", "thick"], settings, tmp_path)
    mesh, time = {"size": 0.4, "size_body": 0.08}, {"step": 0.01, "end": 0.03}
    ours, theirs = (
        rigidfluid.run(falling_disk(mesh=mesh, time=time, output={"every": 0.01}, fluid={"backend": name}))
        for name in ("scikit-fem", "thick")
    )
    found = comparison.pairs[0].differences
    for quantity, prefix in (("position", ""), ("velocity", "v"), ("hydrodynamic_force", "f")):
        apart = [theirs.bodies[prefix + axis] - ours.bodies[prefix + axis] for axis in "xy"]
        assert found[quantity].largest == pytest.approx(np.hypot(*apart).max(), rel=1e-6)
    assert 1e-3 < found["velocity"].relative < 0.1
    assert found["energy"].largest > 0


def test_an_interruption_ends_the_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    processes: list[subprocess.Popen[bytes]] = []

    class Noted(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, *arguments: Any, **keywords: Any) -> None:
            super().__init__(*arguments, **keywords)
            processes.append(self)

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "Popen", Noted)
    monkeypatch.setattr(child, "_POLL", 0.01)
    monkeypatch.setattr(child, "_GRACE", 0.01)
    with pytest.raises(KeyboardInterrupt):
        child.run_apart(BOUNCE, tmp_path / "run", tmp_path / "log", resume=False, watch=interrupted)
    assert [process.returncode for process in processes] == [-signal.SIGKILL]


def test_interruption_tells_how_to_go_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object, **__: object) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(runs, "run_apart", interrupted)
    result = compare_command(BOUNCE, *options("dry", "pushed"), "--out", tmp_path)
    assert result.exit_code == 130
    assert "The same command goes on" in result.stderr
