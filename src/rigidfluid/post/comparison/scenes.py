"""From one scene file to a scene for each backend."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.scene.fluid_table import FluidTable
from rigidfluid.core.scene.overrides import override
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.scene.toml_file import read_toml
from rigidfluid.core.scene.validation import fields_by_key, unknown_key
from rigidfluid.errors import SceneError
from rigidfluid.registry import FLUID_BACKEND, Registry

_OPTION = "--backend"
_COMMON = set(FluidTable.model_fields)
"""Keys of ``[fluid]`` that all backends have."""


def backend_scenes(path: str | Path, backends: Sequence[str], overrides: Iterable[str] = ()) -> dict[str, Scene]:
    """Build the scene of each backend from a scene file and overrides, as `load_scene` takes them.

    Its ``[fluid]`` has the common keys and those that the backend reads. Raises SceneError if the scene or the
    choice of backends is not allowed, PluginError if a part is not there.
    """
    registry = Registry.load()
    parts = _backend_classes(registry, backends)
    tables = read_toml(Path(path))
    override(tables, overrides)
    fluid = tables.get("fluid", {})
    if not isinstance(fluid, Mapping):
        scene_from_dict(tables)  # raises the error of a value in place of a table
    _refuse_unread(fluid, registry, backends)
    scenes = {part.name: _scene(tables, fluid, part) for part in parts}
    for key, given in {"source": scenes[backends[0]].source, "sink": scenes[backends[0]].sink}.items():
        if given:
            raise SceneError(key, "bodies that enter or leave", "a comparison of the same bodies", "Leave it out.")
    return scenes


def _backend_classes(registry: Registry, names: Sequence[str]) -> list[type[FluidBackend]]:
    """Look up two or more backends that solve the same problem."""
    parts = [registry.get(FLUID_BACKEND, name, _OPTION) for name in names]
    doubled = [name for number, name in enumerate(names) if name in names[:number]]
    if doubled:
        raise SceneError(_OPTION, f"{doubled[0]!r} twice", "each backend once", "Remove one of them.")
    if len(names) < 2:
        others = ", ".join(name for name in registry.names(FLUID_BACKEND) if name not in names)
        found = f"{names[0]!r} alone" if names else "none"
        raise SceneError(_OPTION, found, "two or more backends", f"Add another {_OPTION}: {others}.")
    dry = [part.name for part in parts if not part.wet]
    if dry and len(dry) < len(parts):
        found = f"{dry[0]!r}, which has no fluid, together with backends that have one"
        raise SceneError(_OPTION, found, "backends that solve the same problem", f"Leave {dry[0]!r} out.")
    return parts


def _refuse_unread(fluid: Mapping[str, Any], registry: Registry, backends: Sequence[str]) -> None:
    """Refuse a key that no backend has: none of those compared, and not the one that the scene itself names."""
    readers = {*backends, fluid.get("backend", FluidTable.model_fields["backend"].default)}
    options = [one.part.Options for one in registry.entries if one.kind is FLUID_BACKEND and one.name in readers]
    known = _COMMON.union(*map(fields_by_key, options))
    for key in fluid:
        if key not in known:
            raise _with_backends(unknown_key(f"fluid.{key}", known), backends)


def _scene(tables: Mapping[str, Any], fluid: Mapping[str, Any], part: type[FluidBackend]) -> Scene:
    own = set(fields_by_key(part.Options))
    read = {key: value for key, value in fluid.items() if key in _COMMON | own}
    try:
        return scene_from_dict({**tables, "fluid": read | {"backend": part.name}})
    except SceneError as error:
        if error.subject.removeprefix("fluid.") in own:
            raise _with_backends(error, [part.name]) from None
        raise


def _with_backends(error: SceneError, names: Sequence[str]) -> SceneError:
    """The error with the backends' names in its subject."""
    subject = f"{error.subject} with backend {' or '.join(map(repr, names))}"
    return SceneError(subject, error.found, error.allowed, error.remedy)
