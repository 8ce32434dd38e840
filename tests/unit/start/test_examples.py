"""Scenes that come with the package: listed with what they show and cost, and copied."""

from __future__ import annotations

import email
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

import pytest
from paths import ROOT, SCENES
from typer.testing import CliRunner, Result

from rigidfluid.cli import app
from rigidfluid.errors import SceneError
from rigidfluid.start.examples import copy_example, example_names, examples

NAMES = sorted(path.stem for path in SCENES.glob("*.toml"))


def rigidfluid_command(*arguments: object) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200"})


def test_every_shipped_scene_is_an_example_that_says_in_a_sentence_what_it_shows() -> None:
    found = {one.name: one for one in examples()}
    assert sorted(found) == NAMES == example_names()
    assert [name for name, one in found.items() if not one.shows.endswith(".") or len(one.shows) < 20] == []
    assert found["falling_disk"].shows == "A disk falls through a channel onto its floor."
    assert [name for name, one in found.items() if not 0.0 < one.least <= one.most] == []


def test_costs_are_those_of_a_check() -> None:
    from rigidfluid import load_scene
    from rigidfluid.checks import check

    costs = {one.name: (one.least, one.most) for one in examples()}
    for name in ("falling_disk", "rebound", "two_spheres", "dry_bounce"):
        (found,) = [one.found for one in check(load_scene(SCENES / f"{name}.toml")).findings if one.question == "time"]
        assert costs[name] == pytest.approx([found["least"] * found["speed"], found["most"] * found["speed"]], rel=0.06)


@pytest.mark.parametrize("name", NAMES)
def test_errors_of_a_check_are_those_that_the_scene_tells_of(name: str) -> None:
    from rigidfluid import load_scene
    from rigidfluid.checks import check

    (told,) = [one.errors for one in examples() if one.name == name]
    assert check(load_scene(SCENES / f"{name}.toml")).count("error") == told


def test_the_command_tells_of_errors_of_a_check() -> None:
    (line,) = [one for one in rigidfluid_command("examples").stdout.splitlines() if " fast_disk " in one]
    assert "`rigidfluid check`: 1 error." in line


def test_the_command_lists_all_with_their_costs() -> None:
    result = rigidfluid_command("examples")
    assert result.exit_code == 0
    assert [name for name in NAMES if f" {name} " not in result.stdout] == []
    (line,) = [line for line in result.stdout.splitlines() if " rebound " in line]
    assert "A heavy disk is thrown at a wall" in line
    assert line.rstrip().endswith(" s")


@pytest.mark.parametrize("name", NAMES)
def test_a_copy_has_all_files_that_the_scene_names(name: str, tmp_path: Path) -> None:
    scene, *_ = copy_example(name, tmp_path)
    assert scene.read_bytes() == (SCENES / f"{name}.toml").read_bytes()
    tables = tomllib.loads(scene.read_text())
    for table in (tables["domain"], *tables.get("body", ())):
        assert "file" not in table or (tmp_path / table["file"]).is_file()


def test_a_copy_is_told_with_the_next_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = rigidfluid_command("examples", "wavy_channel")
    assert result.stdout == ("wrote wavy_channel.toml, wavy_channel.msh\nnext: rigidfluid run wavy_channel.toml\n")
    assert "rigidfluid insert insertion_2d.toml" in rigidfluid_command("examples", "insertion_2d").stdout
    assert (tmp_path / "insertion" / "vessel.msh").is_file()


def test_nothing_is_overwritten_not_even_in_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wavy_channel.msh").write_text("mine")
    result = rigidfluid_command("examples", "wavy_channel")
    assert result.exit_code == 2
    assert "wavy_channel.msh: found a file that is there" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["wavy_channel.msh"]
    assert (tmp_path / "wavy_channel.msh").read_text() == "mine"


def test_a_name_that_there_is_not_is_refused_with_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="Did you mean 'falling_disk'"):
        copy_example("faling_disk", tmp_path)
    with pytest.raises(SceneError, match="one of bounce_in_fluid"):
        copy_example("../README", tmp_path)


def test_a_wheel_and_a_source_archive_have_the_scenes(tmp_path: Path) -> None:
    """The wheel is made from the archive, unpacked elsewhere, and asked where nothing else of the package is."""
    import tarfile

    build = pytest.importorskip("hatchling.builders.wheel")
    sdist = pytest.importorskip("hatchling.builders.sdist")
    (archive,) = sdist.SdistBuilder(str(ROOT)).build(directory=str(tmp_path))
    with tarfile.open(archive) as file:
        file.extractall(tmp_path, filter="data")
    source = tmp_path / Path(archive).name.removesuffix(".tar.gz")
    (wheel,) = build.WheelBuilder(str(source)).build(directory=str(tmp_path), versions=["standard"])
    installed = tmp_path / "installed"
    ZipFile(wheel).extractall(installed)
    ask = (
        "import rigidfluid.start.examples as e; print(e.FOLDER); print(*e.example_names()); "
        "e.copy_example('wavy_channel', e.Path())"
    )
    environment = os.environ | {"PYTHONPATH": str(installed)}
    told = subprocess.run(
        [sys.executable, "-c", ask], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert told == [str(installed / "rigidfluid" / "scenes"), " ".join(NAMES)]
    assert (tmp_path / "wavy_channel.msh").read_bytes() == (SCENES / "wavy_channel.msh").read_bytes()
    assert (installed / "rigidfluid" / "scenes" / "costs.csv").read_text().startswith("scene,least,most\n")
    _check_metadata(installed)


def _check_metadata(installed: Path) -> None:
    """Addresses of the project, and a description whose links lead somewhere on the web, to files that there are."""
    (path,) = installed.glob("*.dist-info/METADATA")
    metadata = email.message_from_string(path.read_text(encoding="utf-8"))
    addresses = dict(line.split(", ", 1) for line in metadata.get_all("Project-URL") or [])
    assert set(addresses) == {"Homepage", "Documentation", "Source", "Changelog", "Issues"}
    assert metadata["Description-Content-Type"] == "text/markdown"
    links = re.findall(r"\]\(([^)]+)\)", metadata.get_payload())
    files = [link.partition("/main/")[2] for link in links if link.startswith(f"{addresses['Source']}/")]
    assert len(files) > 10
    assert [file for file in files if not (ROOT / file).exists()] == []
    assert [link for link in links if not link.startswith("https://")] == []


@pytest.mark.parametrize(
    "plugin", sorted((ROOT / "plugins").glob("*/pyproject.toml")), ids=lambda path: path.parent.name
)
def test_plug_ins_have_addresses_and_absolute_links(plugin: Path) -> None:
    project = tomllib.loads(plugin.read_text(encoding="utf-8"))["project"]
    assert set(project["urls"]) == {"Homepage", "Documentation", "Source", "Changelog", "Issues"}
    links = re.findall(r"\]\(([^)]+)\)", plugin.with_name(project["readme"]).read_text(encoding="utf-8"))
    assert [link for link in links if not link.startswith(("https://", "#"))] == []
    files = [link.partition("/main/")[2].partition("#")[0] for link in links if "/rigidfluid/blob/main/" in link]
    assert [file for file in files if not (ROOT / file).exists()] == []
