"""Scenes that come with the package: what each shows, what it costs, and a copy to work on."""

from __future__ import annotations

import csv
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.named_files import named_files
from rigidfluid.errors import SceneError
from rigidfluid.start.new_file import write_new

_PACKAGE = Path(__file__).parents[1]
_IN_WHEEL, _IN_CLONE = _PACKAGE / "scenes", _PACKAGE.parents[1] / "scenes"
FOLDER = _IN_WHEEL if _IN_WHEEL.is_dir() else _IN_CLONE
"""Folder of the scenes."""


@dataclass(frozen=True, slots=True)
class Example:
    """A scene: what it ``shows``, the ``least`` and ``most`` CPU time that a run takes [s], and how many ``errors`` a
    check finds."""

    name: str
    shows: str
    least: float
    most: float
    errors: int


def example_names() -> list[str]:
    """Names of all scenes, in alphabetical order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def examples() -> list[Example]:
    """All scenes, those that cost least first."""
    with (FOLDER / "costs.csv").open(encoding="utf-8", newline="") as file:
        costs = {row["scene"]: (float(row["least"]), float(row["most"])) for row in csv.DictReader(file)}
    comments = {name: _comment(name) for name in example_names()}
    found = [Example(name, _first_sentence(text), *costs[name], _errors(text)) for name, text in comments.items()]
    return sorted(found, key=lambda one: (one.most, one.name))


def copy_example(name: str, folder: Path) -> tuple[Path, ...]:
    """Copy a scene and the files that it names into a folder; the scene's path is the first that is returned.

    Raises SceneError for a name that there is not, OutputError where a file is there already or cannot be written.
    """
    if name not in example_names():
        remedy = suggestion(name, example_names()) or "`rigidfluid examples` lists them."
        raise SceneError("examples", repr(name), f"one of {', '.join(example_names())}", remedy)
    text = (FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    files = dict.fromkeys((f"{name}.toml", *named_files(tomllib.loads(text))))
    copies = {folder / file: (FOLDER / file).read_bytes() for file in files}
    write_new(copies)
    return tuple(copies)


def command_for(name: str) -> str:
    """The command that a scene is for: the one that its opening comment names, else ``run``."""
    named = re.search(r"`rigidfluid (\w+)` meshes", _comment(name))
    return named[1] if named else "run"


def _comment(name: str) -> str:
    """A scene's opening comment."""
    lines = re.match(r"(#.*\n)+", (FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    assert lines is not None
    return " ".join(line.removeprefix("#").strip() for line in lines[0].splitlines())


def _errors(comment: str) -> int:
    """The number of errors of a check that a comment tells of."""
    told = re.search(r"Errors of `rigidfluid check`: (\d+)", comment)
    return int(told[1]) if told else 0


def _first_sentence(text: str) -> str:
    return re.split(r"(?<=\.)\s", text, maxsplit=1)[0]
