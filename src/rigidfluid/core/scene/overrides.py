"""Values from the command line (``body.0.density=1.5``) put into a scene's tables before they are validated."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from typing import Any

from rigidfluid.core.scene.validation import value_text
from rigidfluid.errors import SceneError

_WORD = re.compile(r"[A-Za-z][\w-]*")


def override(data: dict[str, Any], assignments: Iterable[str]) -> None:
    """Set values in the scene's tables, in place, by assignments ``key=value``: a dotted key, in which numbers count
    the entries of lists from 0; a TOML value, or one bare word. Raises SceneError for an unreadable assignment or an
    unknown key."""
    for assignment in assignments:
        path, equals, text = assignment.partition("=")
        if not equals or not all(key.strip() for key in path.split(".")):
            raise SceneError("--set", repr(assignment), "key=value", "For instance: --set contact.range=0.02")
        assign(data, path.strip(), _value(path.strip(), text.strip()))


def assign(data: dict[str, Any], path: str, value: Any) -> None:
    """Set one value in the scene's tables, in place; numbers in the dotted key ``path`` count the entries of lists from
    0. Raises SceneError for a key that leads nowhere."""
    *parents, key = path.split(".")
    table: Any = data
    for parent in parents:
        table = table.setdefault(parent, {}) if isinstance(table, dict) else _entry(table, parent, path)
    if isinstance(table, dict):
        table[key] = value
    else:
        _entry(table, key, path)
        table[int(key)] = value


def _value(path: str, text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        parsed = {}
    if set(parsed) == {"value"}:
        return parsed["value"]
    if _WORD.fullmatch(text):
        return text
    raise SceneError(
        path, value_text(text), "a TOML value, or one word", 'For instance: 0.02, [0.0, 1.0], "a text", stokes.'
    )


def _entry(table: Any, key: str, path: str) -> Any:
    if not isinstance(table, list):
        raise SceneError(path, f"{key!r} below a value", "a key of a table", "`rigidfluid schema` lists all keys.")
    if not (key.isdecimal() and int(key) < len(table)):
        last = len(table) - 1
        raise SceneError(path, f"{key!r} in a list", f"a number from 0 to {last}", "Count the entries from 0.")
    return table[int(key)]
