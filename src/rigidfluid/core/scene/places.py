"""Lines of a scene file in which values stand, for its errors."""

from __future__ import annotations

import tomllib
from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rigidfluid.errors import PluginError, RigidfluidError, SceneError, SceneErrors

_CLOSINGS = ("", "]", "]]", "]]]")
"""Ends of lists that are open after a line."""


@contextmanager
def told_in_file(path: Path, assignments: Sequence[str] = ()) -> Iterator[None]:
    """Say in errors of the scene in a file in which line each value stands, in the order of the lines, or which of the
    ``assignments`` of the command line it comes from."""
    try:
        yield
    except (SceneError, PluginError) as error:
        if error.subject == str(path):
            raise  # it cannot be read
        errors = error.single_errors
        lines = path.read_text(encoding="utf-8").splitlines()
        order = {id(one): _tell_place(one, path, lines, assignments) for one in errors}
        if isinstance(error, SceneErrors):
            raise SceneErrors(sorted(errors, key=lambda one: order[id(one)])) from None
        raise


@contextmanager
def told_where_set(path: Path, keys: Mapping[str, Sequence[str]]) -> Iterator[None]:
    """Say in errors of a scene in which line of another file the values stand that tables of it set; ``keys`` of the
    scene by table."""
    try:
        yield
    except (SceneError, PluginError) as error:
        lines = path.read_text(encoding="utf-8").splitlines()
        for one in error.single_errors:
            table = next((table for table in keys if any(_is_within(one.subject, key) for key in keys[table])), None)
            if table is not None:
                one.place = f"{path}:{line_of(f'{table}.{one.subject}', lines)}"
        raise


def line_of(field: str, lines: Sequence[str]) -> int | None:
    """Number of the line in which a field stands (``body.0.density``), or else the nearest table around it; from 1,
    None where the text has neither. A field may tell more after a comma (``swarm.0.file, line 3``).

    It is the first line down to which the text has the field already: the text above is read as TOML.
    """
    keys = _key(field).split(".")
    for count in range(len(keys), 0, -1):
        if _has(lines, keys[:count]):
            return bisect_left(range(len(lines)), True, key=lambda last: _has(lines[: last + 1], keys[:count])) + 1
    return None


def _tell_place(error: RigidfluidError, path: Path, lines: Sequence[str], assignments: Sequence[str]) -> int:
    """Give an error its place, the file alone for what is missing in it; return its line, 0 of assignments, and one
    after all without a line."""
    if error.place:
        return 0
    for assignment in reversed(assignments):
        key = assignment.partition("=")[0].strip()
        if _is_within(error.subject, key):
            error.place = f"--set {assignment}"
            return 0
    line = line_of(error.subject, lines)
    if line is None:
        if isinstance(error, SceneError):
            error.place = str(path)
        return len(lines) + 1
    error.place = f"{path}:{line}"
    return line


def _is_within(subject: str, key: str) -> bool:
    """Tell whether a subject is a key or lies under it."""
    return f"{_key(subject)}.".startswith(f"{key}.")


def _key(subject: str) -> str:
    """The key of a subject, without the place in a file or the body that it names after a comma."""
    return subject.partition(",")[0]


def _has(lines: Sequence[str], keys: Sequence[str]) -> bool:
    """Tell whether a text, down to its last line that ends a value or an entry of a list, has the keys."""
    for last in range(len(lines), 0, -1):
        for closing in _CLOSINGS:
            try:
                return _reaches(tomllib.loads("\n".join([*lines[:last], closing])), keys)
            except ValueError:
                continue
    return False


def _reaches(value: Any, keys: Sequence[str]) -> bool:
    for key in keys:
        if isinstance(value, list) and key.isdecimal() and int(key) < len(value):
            value = value[int(key)]
        elif isinstance(value, dict) and key in value:
            value = value[key]
        else:
            return False
    return True
