"""The settings of a run in full, as a command that can be pasted: a scene file and its ``--set``."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import rigidfluid
from page_tools.places import ROOT, SCENES
from rigidfluid.core.scene.scene import Scene


@dataclass(frozen=True)
class Settings:
    """A scene as a ``file`` of the repository with ``overrides``; or, where no file is near it, as ``tables``."""

    file: str = ""
    overrides: list[str] = field(default_factory=list)
    tables: dict[str, Any] | None = None

    @property
    def scene(self) -> Scene:
        """The scene."""
        if self.tables is not None:
            return rigidfluid.scene_from_dict(self.tables)
        return rigidfluid.load_scene(ROOT / self.file, self.overrides)

    @property
    def command(self) -> str:
        """What runs it, by hand; nothing where it has no file."""
        words = [word for one in self.overrides for word in ("--set", one)]
        return shlex.join(["rigidfluid", "run", self.file, *words]) if self.file else ""


def settings_of(scene: Scene) -> Settings:
    """Settings of a scene, by what it differs in from the file of scenes/ that has its name."""
    tables = scene.to_dict()
    path = SCENES / f"{tables['scene'].get('name', '')}.toml"
    if path.is_file():
        overrides = list(_overrides(rigidfluid.load_scene(path).to_dict(), tables))
        found = Settings(str(path.relative_to(ROOT)), overrides)
        if found.scene.to_dict() == tables:
            return found
    return Settings(tables=tables)


def _overrides(base: Any, wanted: Any, key: str = "") -> Iterator[str]:
    """What ``--set`` must say to make the tables ``wanted`` of others; a table with a key too many is set whole."""
    if base == wanted:
        return
    keyed = [dict(enumerate(one)) if isinstance(one, list) and _are_tables(one) else one for one in (base, wanted)]
    before, after = keyed
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() <= after.keys() and _can(base, wanted):
        for name, value in after.items():
            yield from _overrides(before.get(name), value, f"{key}.{name}" if key else str(name))
    elif wanted is not None:
        yield override(key, wanted)


def override(key: str, value: Any) -> str:
    """Assignment for ``--set`` of a value of any kind."""
    return f"{key}={_toml(value)}"


def _can(base: Any, wanted: Any) -> bool:
    """Whether entries can be set one by one: a list must be as long."""
    return not isinstance(wanted, list) or len(base) == len(wanted)


def _are_tables(entries: list[Any]) -> bool:
    return bool(entries) and all(isinstance(entry, dict) for entry in entries)


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        inner = ", ".join(f"{json.dumps(name)} = {_toml(one)}" for name, one in value.items() if one is not None)
        return "{" + inner + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)
