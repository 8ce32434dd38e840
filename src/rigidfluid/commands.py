"""Arguments and options that rigidfluid's commands share, and those of plug-ins with them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Annotated

import typer

_CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f]")


def named_path(path: str | Path) -> Path:
    """Path of what is to be written. An empty one would be the working folder, unasked; blanks and control characters
    are not seen where it is shown, or change what is."""
    text = str(path)
    if not text.strip():
        raise typer.BadParameter("an empty name; allowed is a path, such as '.' for the working folder")
    if _CONTROLS.search(text):
        raise typer.BadParameter(f"{text!r} with a control character; allowed is a path of visible ones")
    return Path(text)


SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).")]
"""Path of a scene, for `load_scene`."""

Assignments = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a value, as contact.range=0.02 or body.0.density=1.5."),
]
"""Changes to a scene, for `load_scene`."""

JsonFile = Annotated[
    Path | None, typer.Option("--json", parser=named_path, metavar="FILE", help="Write the same there as JSON.")
]
"""Path of a file, for `write_json`."""


def write_json(data: object, path: Path) -> None:
    """Write numbers, text, lists and mappings as JSON; raises OutputError if the file cannot be written."""
    from rigidfluid.core.output.disk import writing

    with writing(path):
        path.write_text(json.dumps(data, indent=2, allow_nan=False) + "\n", encoding="utf-8")
