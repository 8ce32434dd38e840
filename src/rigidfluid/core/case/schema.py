"""The JSON Schema of scenes, with the keys of every part that is installed."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.case.part_tables import PART_TABLES
from rigidfluid.core.scene.scene import Scene
from rigidfluid.registry import (
    BODY,
    DETECTOR,
    DOMAIN,
    FLUID_BACKEND,
    FORCE_LAW,
    JOINT,
    MECHANISM,
    SIZE_FIELD,
    Entry,
    Registry,
)

# The parts that a table means where it names none.
_UNNAMED = {
    FLUID_BACKEND: ("scikit-fem",),
    DETECTOR: ("sphere", "ellipsoid", "brute_force"),
    BODY: (),
    MECHANISM: (),
    FORCE_LAW: (),
    DOMAIN: ("box",),
    JOINT: (),
    SIZE_FIELD: (),
}


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a scene file: each table that names a part takes that part's keys as well, and no
    others. Raises PluginError if a plug-in is not usable."""
    schema = Scene.model_json_schema()
    registry = Registry.load()
    for _, kind, table in PART_TABLES:
        named = schema["$defs"][table.__name__]["properties"][kind.key]
        named["enum"] = ["auto"] * (kind is DETECTOR) + registry.names(kind)
    for entry in registry.entries:
        _add_part(schema["$defs"], entry)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _add_part(definitions: dict[str, Any], entry: Entry) -> None:
    key = entry.kind.key
    condition: dict[str, Any] = {"properties": {key: {"const": entry.name}}}
    if entry.name not in _UNNAMED[entry.kind]:
        condition["required"] = [key]
    for model in (model for _, kind, model in PART_TABLES if kind is entry.kind):
        table = definitions[model.__name__]
        table.pop("additionalProperties", None)
        table["unevaluatedProperties"] = False
        table.setdefault("allOf", []).append({"if": condition, "then": _options(definitions, entry)})


def _options(definitions: dict[str, Any], entry: Entry) -> dict[str, Any]:
    prefix = f"{entry.kind.title} {entry.name} ".replace(" ", "_")
    schema = entry.part.Options.model_json_schema(ref_template=f"#/$defs/{prefix}{{model}}")
    for name, definition in schema.pop("$defs", {}).items():
        definitions[prefix + name] = definition
    # Its table's own keys stand next to the part's.
    schema.pop("additionalProperties", None)
    return schema
