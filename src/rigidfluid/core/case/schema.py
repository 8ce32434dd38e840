"""The JSON Schema of scenes, with the keys of every part that is installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    MATERIAL,
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
    MATERIAL: (),
}


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 7, which editors know) of a scene file: each table that names a part takes that part's keys as
    well, and no others. Raises PluginError if a plug-in is not usable."""
    schema = Scene.model_json_schema()
    registry, definitions = Registry.load(), schema["$defs"]
    for name, model in {model.__name__: model for _, _, model in PART_TABLES}.items():
        kinds = [kind for _, kind, one in PART_TABLES if one is model]
        parts = [(entry, _options(definitions, entry)) for entry in registry.entries if entry.kind in kinds]
        _add_parts(definitions[name], parts)
        for kind in kinds:
            definitions[name]["properties"][kind.key]["enum"] = ["auto"] * (kind is DETECTOR) + registry.names(kind)
    tables = schema["properties"]["boundary"]
    tables["items"] = _typed_tables(tables["items"]["discriminator"]["mapping"], definitions)
    return {"$schema": "http://json-schema.org/draft-07/schema#"} | {k: _in_draft_7(v) for k, v in schema.items()}


def _add_parts(table: dict[str, Any], parts: Sequence[tuple[Entry, dict[str, Any]]]) -> None:
    """Let a table have the keys of the part that it names: all are listed beside its own, and refused one by one where
    no part has them that the table names."""
    owners: dict[str, list[tuple[Entry, Any]]] = {}
    for entry, options in parts:
        for key, value in options.get("properties", {}).items():
            if key not in table["properties"]:
                owners.setdefault(key, []).append((entry, value))
    conditions = [{"if": _names_it(entry), "then": options} for entry, options in parts]
    for key, found in owners.items():
        named = {"anyOf": [_names_it(entry) for entry, _ in found]}
        conditions.append({"if": named, "else": {"properties": {key: False}}})
    listed = {key: _any_of([value for _, value in found]) for key, found in owners.items()}
    table |= {"properties": listed | table["properties"], "additionalProperties": False, "allOf": conditions}


def _names_it(entry: Entry) -> dict[str, Any]:
    """Schema of the tables that name a part, or mean it without a name."""
    key = entry.kind.key
    named: dict[str, Any] = {"properties": {key: {"const": entry.name}}}
    return named if entry.name in _UNNAMED[entry.kind] else {**named, "required": [key]}


def _typed_tables(mapping: Mapping[str, str], definitions: Mapping[str, Any]) -> dict[str, Any]:
    """Schema of tables of several types: the keys of all, with the table of each type by its reference."""
    keys: dict[str, list[Any]] = {}
    for table in dict.fromkeys(mapping.values()):
        for key, value in definitions[table.rpartition("/")[2]]["properties"].items():
            keys.setdefault(key, []).append(value)
    conditions = [
        {"if": {"properties": {"type": {"const": name}}, "required": ["type"]}, "then": {"$ref": table}}
        for name, table in mapping.items()
    ]
    listed = {key: _any_of(values) for key, values in keys.items()}
    listed["type"] = {"enum": list(mapping), "description": "The condition"}
    return {
        "type": "object",
        "properties": listed,
        "required": ["on", "type"],
        "additionalProperties": False,
        "allOf": conditions,
    }


def _any_of(schemas: Sequence[Any]) -> Any:
    """Schema of whatever one of several allows."""
    different = [schema for number, schema in enumerate(schemas) if schema not in schemas[:number]]
    return different[0] if len(different) == 1 else {"anyOf": different}


def _options(definitions: dict[str, Any], entry: Entry) -> dict[str, Any]:
    prefix = f"{entry.kind.title} {entry.name} ".replace(" ", "_")
    schema = entry.part.Options.model_json_schema(ref_template=f"#/$defs/{prefix}{{model}}")
    for name, definition in schema.pop("$defs", {}).items():
        definitions[prefix + name] = definition
    # Its table's own keys stand next to the part's.
    schema.pop("additionalProperties", None)
    return schema


def _in_draft_7(schema: Any) -> Any:
    """The schema with what this draft calls otherwise: of lists the places."""
    if isinstance(schema, list):
        return [_in_draft_7(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    return {"items" if key == "prefixItems" else key: _in_draft_7(value) for key, value in schema.items()}
