"""A study of a ball that falls freely, without a fluid: each figure is known."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner, Result

from rigidfluid.cli import app

SCENE = """\
[scene]
name = "fall"
dimension = 2

[fluid]
backend = "dry"
gravity = [0.0, -10.0]

[domain]
type = "box"
lower = [0.0, 0.0]
upper = [10.0, 10.0]

[[body]]
name = "ball"
type = "sphere"
radius = 0.1
density = 1.0
position = [5.0, 5.0]

[contact]
law = "centre"
range = 0.02
epsilon = 1e-8

[time]
end = 0.5
step = 0.25

[output]
every = 0.5
"""
HEIGHT = '{ table = "bodies", column = "y", at = 0.5 }'


def falling_study(folder: Path, tables: str, figure: str = HEIGHT, error: str = "") -> Path:
    """Path of a study file with these ``tables`` and [error]'s ``figure``; ``error`` has more keys of that table."""
    (folder / "fall.toml").write_text(SCENE)
    path = folder / "fall_study.toml"
    path.write_text(f'[study]\nname = "fall"\nscene = "fall.toml"\n{tables}\n[error]\nfigure = {figure}\n{error}\n')
    return path


def command(path: Path) -> Result:
    """Run a study by the command, into the folder ``out`` beside it."""
    return CliRunner().invoke(app, ["study", str(path), "--out", str(path.parent / "out")], env={"COLUMNS": "200"})


def check_refusal(result: Result, *texts: str) -> None:
    """A command has said in one line, with these texts, what is wrong."""
    assert result.exit_code == 2
    assert result.stderr.startswith("Error: ")
    assert result.stderr.count("\n") == 1
    for text in texts:
        assert text in result.stderr
