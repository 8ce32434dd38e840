"""A new scene: whatever is asked for, its check has nothing to warn of; and the command that writes it."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from rigidfluid import load_scene
from rigidfluid.checks import check
from rigidfluid.cli import app
from rigidfluid.errors import SceneError
from rigidfluid.start.new_scene import new_scene
from rigidfluid.start.wishes import Wishes

GRID = [
    (),
    ("--bodies", 3, "--fluid", "water"),
    ("--shape", "ellipsoid", "--bodies", 2),
    ("--shape", "polygon", "--units", "m"),
    ("--fluid", "glycerine", "--units", "mm", "--bodies", 4),
    ("--gravity", 0),
    ("--gravity", 98.1, "--size", 5),
    ("--fluid", "none", "--bodies", 5),
    ("--fluid", "none", "--gravity", 0, "--shape", "polygon", "--bodies", 2),
    ("--dimension", 3),
    ("--dimension", 3, "--shape", "ellipsoid", "--bodies", 2, "--units", "m"),
    ("--dimension", 3, "--fluid", "none", "--bodies", 9),
]


def new(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["new", *map(str, arguments)], env={"COLUMNS": "200"})


@pytest.mark.parametrize(
    ("option", "value"),
    [
        *(("--size", value) for value in (-1, 0, "inf", "nan", 1e-31, 1e20, 1e40)),
        *(("--gravity", value) for value in (-9.81, "inf", "nan", 1e25, 1e40)),
    ],
)
def test_odd_numbers_are_refused_by_their_option(option: str, value: object, tmp_path: Path) -> None:
    refused = new(tmp_path / "mine.toml", f"{option}={value}")
    assert refused.exit_code == 2
    assert refused.stderr.startswith("Error: --")
    assert option in refused.stderr.partition(": ")[2].partition(": ")[0]


def test_gravity_with_a_sign_or_of_other_units_is_told_the_number_to_give(tmp_path: Path) -> None:
    assert "leave the sign out, --gravity 9.81." in new(tmp_path / "mine.toml", "--gravity=-9.81").stderr
    assert "Set --gravity 981," in new(tmp_path / "mine.toml", "--gravity", 9.81).stderr


@pytest.mark.parametrize("flags", GRID, ids=lambda flags: " ".join(map(str, flags)) or "defaults")
def test_what_is_written_passes_its_check_without_a_warning(flags: tuple[object, ...], tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    result = new(file, *flags)
    assert result.exit_code == 0, result.stderr
    told = result.stdout.splitlines()
    assert told[0] == f"wrote {file}"
    assert told[-1] == f"next: rigidfluid run {file}"
    assert any("of one core" in line for line in told)
    scene = load_scene(file)
    report = check(scene)
    assert [finding.text for finding in report.findings if finding.grade != "note"] == []
    asked = dict(zip(flags[::2], flags[1::2], strict=True))
    assert scene.dimension == asked.get("--dimension", 2)
    assert scene.scene.units is not None
    assert scene.scene.units.length == asked.get("--units", "cm")
    assert [body.type for body in scene.body] == [asked.get("--shape", "sphere")] * int(str(asked.get("--bodies", 1)))
    assert (scene.fluid.backend == "dry") == (asked.get("--fluid") == "none")
    lines = file.read_text().splitlines()
    assert lines[0].startswith("# ")
    assert "Units: " in lines[0]


@pytest.mark.long
@pytest.mark.long
def test_units_change_numbers_and_not_the_run() -> None:
    runs = [check(scene) for scene in map(_made, ("cm", "m", "mm"))]
    weights = [report.bodies[0].submerged_weight[1] for report in runs]
    assert weights == pytest.approx([weights[0], 1e-3 * weights[0], 1e3 * weights[0]], rel=1e-3)  # dyn/cm, N/m, mg/s²
    speeds = [report.bodies[0].impact_speed for report in runs]
    assert speeds == pytest.approx([speeds[0], 1e-2 * speeds[0], 10.0 * speeds[0]], rel=1e-3)


def _made(units: str) -> object:
    import tomllib

    from rigidfluid import scene_from_dict

    return scene_from_dict(tomllib.loads(new_scene(Wishes(units=units), "mine")[0]))  # type: ignore[arg-type]


def test_a_file_that_is_there_stays(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text("mine")
    result = new(file)
    assert result.exit_code == 2
    assert "a file that is there" in result.stderr
    assert file.read_text() == "mine"


@pytest.mark.long
def test_what_cannot_be_is_refused(tmp_path: Path) -> None:
    assert "sphere, ellipsoid" in new(tmp_path / "a.toml", "--shape", "polygon", "--dimension", 3).stderr
    assert new(tmp_path / "a.toml", "--shape", "cube").exit_code == 2
    with pytest.raises(SceneError, match=r"a check still warns: .*memory.* Choose another --size or --fluid"):
        new_scene(Wishes(dimension=3, fluid="water", size=300.0), "mine")
    with pytest.raises(SceneError, match=r"gravity is the Earth's in m/s²"):
        new_scene(Wishes(gravity=9.81, size=5.0), "mine")  # units are cm
    assert list(tmp_path.iterdir()) == []


def test_questions_are_asked_on_a_terminal_alone(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "rigidfluid", "new", "mine.toml", "--shape", "ellipsoid", "--size", "3"]
    ours, theirs = pty.openpty()
    environment = os.environ | {"TERM": "dumb"}
    pipes = {"stdin": theirs, "stderr": theirs, "stdout": subprocess.PIPE}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, **pipes) as asked:  # type: ignore[call-overload]
        os.write(ours, b"mm\n\n2\nnone\n")  # units, dimension, bodies, fluid
        assert b"wrote mine.toml" in asked.communicate()[0]
    assert asked.returncode == 0
    scene = load_scene(tmp_path / "mine.toml")
    assert [body.type for body in scene.body] == ["ellipsoid"] * 2
    assert (scene.domain.options["upper"][0], scene.fluid.gravity) == (3.0, (0.0, -9810.0))
    assert scene.fluid.backend == "dry"
    os.close(ours)
    os.close(theirs)
