"""Arguments and options that rigidfluid's commands share, and those of plug-ins with them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

SceneFile = Annotated[Path, typer.Argument(metavar="SCENE", help="Scene file (TOML).")]
"""Path of a scene, for `load_scene`."""

Assignments = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a value, as contact.range=0.02 or body.0.density=1.5."),
]
"""Changes to a scene, for `load_scene`."""

JsonFile = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write the same there as JSON.")]
"""Path of a file, for `write_json`."""


def write_json(data: object, path: Path) -> None:
    """Write numbers, text, lists and mappings as JSON; raises OutputError if the file cannot be written."""
    from rigidfluid.core.output.disk import writing

    with writing(path):
        path.write_text(json.dumps(data, indent=2, allow_nan=False) + "\n", encoding="utf-8")
