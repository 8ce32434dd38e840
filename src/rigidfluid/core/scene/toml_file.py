"""TOML files of scenes and studies, with the files that their tables name."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from rigidfluid.errors import SceneError
from rigidfluid.regular_file import MOST_TEXT, require_regular

_COMMANDS = {"scene": "run", "study": "study"}
"""Commands that take a file, by the table that tells its kind."""


def read_toml(path: Path, kind: str = "scene") -> dict[str, Any]:
    """Read the tables of a TOML file; ``kind`` says in messages what file it should be.

    The path under a key ``file`` is relative to the file it stands in.
    """
    require_regular(path, str(path), MOST_TEXT, f"a readable {kind} file")
    try:
        tables = _resolve_files(tomllib.loads(path.read_text(encoding="utf-8")), path.resolve().parent)
    except OSError as error:
        raise SceneError(str(path), error.strerror, f"a readable {kind} file", "Check path and permissions.") from None
    except (ValueError, RecursionError) as error:
        raise SceneError(str(path), f"invalid TOML ({error})", "a TOML file in UTF-8", "Mend the file there.") from None
    _refuse_other_kind(tables, path, kind)
    return tables


def _refuse_other_kind(tables: dict[str, Any], path: Path, kind: str) -> None:
    """Raise SceneError where the file is a scene in place of a study, or a study in place of a scene."""
    for other, command in _COMMANDS.items():
        if other in tables and kind not in tables:
            remedy = f"`rigidfluid {command} {path}` takes this file."
            raise SceneError(str(path), f"a {other} file, with a table [{other}]", f"a {kind} file", remedy)


def _resolve_files(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A table with every ``file`` in it, and in the tables within, as an absolute path, seen from a folder."""
    found = {key: _resolve_each_file(inner, folder) for key, inner in table.items()}
    return found | {"file": str(folder / found["file"])} if isinstance(found.get("file"), str) else found


def _resolve_each_file(value: Any, folder: Path) -> Any:
    if isinstance(value, list):
        return [_resolve_each_file(inner, folder) for inner in value]
    return _resolve_files(value, folder) if isinstance(value, dict) else value
