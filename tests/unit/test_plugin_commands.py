"""Commands of plug-ins made on the spot: how they are found, called, listed and refused."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from collections.abc import Callable
from importlib.metadata import EntryPoints
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from rigidfluid.cli import app
from rigidfluid.plugin_commands import GROUP, PACKAGES

SCENE = Path(__file__).parents[2] / "scenes" / "dry_bounce.toml"
WEIGH = """
    import typer
    from rigidfluid.api import SceneError, build_system, load_scene
    from rigidfluid.commands import Assignments, SceneFile

    def weigh(scene: SceneFile, assignments: Assignments = None, least: float = 0.0) -> None:
        \"\"\"Print the mass of each body.\"\"\"
        system = build_system(load_scene(scene, assignments or ()))
        for name, mass in zip(system.surfaces, system.mass):
            typer.echo(f"{name} {mass:.3g}")
            if mass < least:
                raise typer.Exit(3)
        if least < 0.0:
            raise SceneError("least", least, "a mass", "Raise it.")
"""
Install = Callable[..., Path]


def call(*arguments: object) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200"})


def call_apart(*arguments: object, path: Path) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own, with a folder of plug-ins on its path."""
    command = [sys.executable, "-m", "rigidfluid", *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(path), *filter(None, sys.path)])}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def row(text: str, word: str) -> list[str]:
    """Cells of the first line of a table that has a word."""
    line = next(line for line in text.splitlines() if word in line)
    return [cell.strip() for cell in line.split("│")[1:-1]]


@pytest.fixture
def weigh(install: Install) -> Callable[..., Path]:
    """Installs the command, with changes to its code, under a name."""

    def install_command(old: str = "", new: str = "", command: str = "weigh", package: str = "weighing") -> Path:
        module = f"{package}_plugin"
        points = f"[rigidfluid.commands]\n{command} = {module}:weigh\n"
        return install(WEIGH.replace(old, new) if old else WEIGH, package, module, points)

    return install_command


def test_it_runs_with_its_arguments(weigh: Install) -> None:
    weigh()
    result = call("weigh", SCENE, "--set", "body.0.density=2")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines() == ["left_disk 0.0628", "right_disk 0.0314"]


def test_it_may_be_called_by_another_process(weigh: Install) -> None:
    ended = call_apart("weigh", SCENE, path=weigh())
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "left_disk 0.0314" in ended.stdout


def test_its_help_is_its_own(weigh: Install) -> None:
    weigh()
    text = call("weigh", "--help").stdout
    for words in ("weigh [OPTIONS]", "Print the mass of each body.", "--least", "--set"):
        assert words in text


@pytest.mark.parametrize(
    ("arguments", "words"),
    [([], "Missing argument"), ([SCENE, "--most", "1"], "--most"), ([SCENE, "--least", "x"], "Invalid value")],
)
def test_wrong_arguments_are_told_as_of_any_command(weigh: Install, arguments: list[object], words: str) -> None:
    weigh()
    result = call("weigh", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert "fault" not in result.stderr


def test_an_error_of_rigidfluid_is_one_paragraph(weigh: Install) -> None:
    weigh()
    missing, raised = call("weigh", "missing.toml"), call("weigh", SCENE, "--least", "-1")
    assert (missing.exit_code, raised.exit_code) == (2, 2)
    assert missing.stderr.startswith("Error: missing.toml: found No such file")
    assert raised.stderr == "Error: least: found -1.0; allowed is a mass. Raise it.\n"


def test_it_may_end_with_an_exit_code(weigh: Install) -> None:
    weigh()
    result = call("weigh", SCENE, "--least", "1")
    assert (result.exit_code, result.stderr) == (3, "")


def test_another_error_is_said_to_be_a_fault(weigh: Install) -> None:
    weigh("system.surfaces", "system.nothing")
    result = call("weigh", SCENE)
    assert isinstance(result.exception, AttributeError)
    assert result.stderr.startswith("A fault in rigidfluid or in a plug-in.")


def test_help_and_the_list_of_plug_ins_name_it(weigh: Install) -> None:
    path = weigh()
    assert "A command of weighing 1.2." in call("--help").stdout
    assert row(call("plugins").stdout, "weigh") == ["command", "weigh", "weighing 1.2", "yes"]
    metadata = path / "weighing-1.2.dist-info" / "METADATA"
    metadata.write_text(metadata.read_text() + "Summary: Weigh bodies\n")
    assert "Weigh bodies" in call("--help").stdout


def test_nothing_of_it_is_imported_before_it_is_called(weigh: Install) -> None:
    path = weigh("import typer", "import typer; 1 / 0")
    code = "import sys; from rigidfluid.cli import app; app(sys.argv[1:], standalone_mode=False); print(*sys.modules)"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(path), *filter(None, sys.path)])}
    for arguments in (["--help"], ["--version"], ["check", str(SCENE)]):
        command = [sys.executable, "-c", code, *arguments]
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert ended.returncode == 0, ended.stderr
        assert "weighing_plugin" not in ended.stdout.splitlines()[-1].split()


BROKEN = {
    "a missing package": ("import typer", "import no_such_package", "`pip install weighing`"),
    "a fault": ("import typer", "1 / 0", "ZeroDivisionError: division by zero"),
    "an exit": ("import typer", "raise SystemExit(4)", "SystemExit: 4"),
    "no function": ("def weigh", "weigh = 3\n\n    def weight", "found 3; allowed is a function"),
    "another name": ("def weigh", "def weight", "AttributeError"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_one_is_told_and_breaks_nothing_else(weigh: Install, case: str) -> None:
    old, new, words = BROKEN[case]
    weigh(old, new)
    result = call("weigh", SCENE)
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: command 'weigh' of weighing 1.2: found ")
    assert words in result.stderr
    assert result.stderr.count("\n") == 1
    listed = call("plugins")
    assert listed.exit_code == 0
    assert row(listed.stdout, "weigh")[3].startswith("no: ")
    assert call("check", SCENE).exit_code == 0


def test_rigidfluids_own_command_keeps_its_name(weigh: Install) -> None:
    weigh(command="check")
    assert "left_disk 0.0314\n" not in call("check", SCENE).stdout
    assert call("--help").stdout.count(" check ") == 1
    assert row(call("plugins").stdout, "weighing")[3] == "no: rigidfluid has a command of that name"


def test_two_of_one_name_are_refused_by_their_packages(weigh: Install) -> None:
    weigh()
    weigh(package="scales")
    result = call("weigh", SCENE)
    assert result.exit_code == 2
    assert "command 'weigh' of" in result.stderr
    assert "scales 1.2" in result.stderr
    assert "weighing 1.2" in result.stderr
    assert call("--help").exit_code == 0
    assert "no: the name more than once" in call("plugins").stdout


def test_a_command_of_a_package_beside_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rigidfluid.plugin_commands.entry_points", lambda group: EntryPoints())
    result = call("crosscheck", SCENE)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("Error: `rigidfluid crosscheck` comes with the package rigidfluid-lammps, which")
    assert result.stderr.count("\n") == result.stderr.count(". ") + 1 == 1
    assert "crosscheck" not in call("--help").stdout


def test_packages_beside_are_there_and_bring_their_commands() -> None:
    for command, package in PACKAGES.items():
        project = tomllib.loads((SCENE.parents[1] / "plugins" / package / "pyproject.toml").read_text())["project"]
        assert project["name"] == package
        assert command in project["entry-points"][GROUP]


def test_an_unknown_command_is_no_fault() -> None:
    result = call("weigh", SCENE)
    assert result.exit_code == 2
    assert "No such command 'weigh'" in result.stderr
