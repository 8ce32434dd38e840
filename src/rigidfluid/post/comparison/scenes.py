"""From one scene file to a scene for each backend."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.model.interfaces import FluidBackend
from rigidfluid.core.scene.overrides import override
from rigidfluid.core.scene.scene import FluidTable, Scene, read_toml
from rigidfluid.core.scene.validation import fields_by_key, unknown_key
from rigidfluid.errors import SceneError
from rigidfluid.registry import FLUID_BACKEND, Registry

_FIELD = "--backend"
_COMMON = set(FluidTable.model_fields)


def backend_scenes(path: str | Path, backends: Sequence[str], overrides: Iterable[str] = ()) -> dict[str, Scene]:
    """Build the scene of each backend from a scene file and overrides, as `load_scene` takes them.

    Each has of ``[fluid]`` the common keys and those that its backend reads. Raises SceneError if the scene or the
    choice of backends is not allowed, PluginError if a part is not there.
    """
    registry = Registry.load()
    parts = _parts(registry, backends)
    tables = read_toml(Path(path))
    override(tables, overrides)
    if not isinstance(tables.get("fluid", {}), Mapping):
        scene_from_dict(tables)  # it says what is wrong
    _refuse_unread(tables.get("fluid", {}), registry, backends)
    return {part.name: _scene(tables, part) for part in parts}


def _parts(registry: Registry, names: Sequence[str]) -> list[type[FluidBackend]]:
    parts = [registry.get(FLUID_BACKEND, name, _FIELD) for name in names]
    doubled = [name for number, name in enumerate(names) if name in names[:number]]
    if doubled:
        raise SceneError(_FIELD, f"{doubled[0]!r} twice", "each backend once", "Remove one of them.")
    if len(names) < 2:
        others = ", ".join(name for name in registry.names(FLUID_BACKEND) if name not in names)
        found = f"{names[0]!r} alone" if names else "none"
        raise SceneError(_FIELD, found, "two or more backends", f"Add another {_FIELD}: {others}.")
    dry = [part.name for part in parts if not part.wet]
    if dry and len(dry) < len(parts):
        found = f"{dry[0]!r}, which has no fluid, together with backends that have one"
        raise SceneError(_FIELD, found, "backends that solve the same problem", f"Leave {dry[0]!r} out.")
    return parts


def _refuse_unread(fluid: Mapping[str, Any], registry: Registry, backends: Sequence[str]) -> None:
    """Each key must belong to all, to a backend that is compared, or to the one that the scene itself names."""
    named = {*backends, fluid.get("backend", FluidTable.model_fields["backend"].default)}
    readers = [entry.part for entry in registry.entries if entry.kind is FLUID_BACKEND and entry.name in named]
    known = _COMMON.union(*(fields_by_key(reader.Options) for reader in readers))
    for key in fluid:
        if key not in known:
            who = " or ".join(map(repr, backends))
            raise _naming(unknown_key(f"fluid.{key}", known), f"with backend {who}")


def _scene(tables: Mapping[str, Any], part: type[FluidBackend]) -> Scene:
    own = set(fields_by_key(part.Options))
    fluid = {key: value for key, value in tables.get("fluid", {}).items() if key in _COMMON | own}
    try:
        return scene_from_dict({**tables, "fluid": fluid | {"backend": part.name}})
    except SceneError as error:
        if error.subject.removeprefix("fluid.") in own:
            raise _naming(error, f"with backend {part.name!r}") from None
        raise


def _naming(error: SceneError, whose: str) -> SceneError:
    return SceneError(f"{error.subject} {whose}", error.found, error.allowed, error.remedy)
