"""Writes docs/scene.md from the models of a scene and the options of the built-in parts."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rigidfluid.core.scene.scene import Scene
from rigidfluid.registry import Entry, Registry

PATH = Path(__file__).with_name("scene.md")
HEAD = """# What a scene may contain

This page is made from the models by `python docs/make_scene_reference.py`; a test fails if it is out of date.

Units are free but must be consistent, for example all in cm, g and s, or all in m, kg and s. `d` is the dimension. In
2D all quantities are per unit depth: a density has the number of the 3D material's and the unit mass/length² per unit
depth ([what 2D means](units.md#what-2d-means)). Keys that nothing reads are refused. On the command line, `--set
table.key=value` overrides a key; entries of lists are counted from 0, as in `body.0.density`.

Editors that use taplo, such as VS Code with Even Better TOML, complete and check keys and names of parts. For this, run
`rigidfluid schema > scene.schema.json`, and make `#:schema scene.schema.json` the first line of the scene.
"""
Schema = dict[str, Any]


def reference() -> str:
    """The whole page, in Markdown."""
    return "\n".join(dict.fromkeys([HEAD, *_sections(), *_parts()]))  # some parts have tables of one kind


def _sections() -> Iterator[str]:
    schema = Scene.model_json_schema()
    for key, place in schema["properties"].items():
        listed = place.get("type") == "array"
        title = f"[[{key}]]" if listed else f"[{key}]"
        if _union(place):
            yield from _sections_by_type(title, key, place, schema["$defs"])
        else:
            yield from _section(title, key, _target(place), schema["$defs"])


def _sections_by_type(title: str, path: str, place: Schema, definitions: dict[str, Schema]) -> Iterator[str]:
    """Tables whose keys depend on their type."""
    yield f"## `{title}`\n\n{place['description']}.\n"
    union = _union(place)
    key = union["discriminator"]["propertyName"]
    for one in union["oneOf"]:
        name = _target(one)
        kind = _type(definitions[name]["properties"][key]).partition(",")[0].strip("`")
        yield from _section(f"{title} {key} = {kind}", path, name, definitions)


def _section(title: str, path: str, name: str, definitions: dict[str, Schema]) -> Iterator[str]:
    schema = definitions[name]
    yield f"## `{title}`\n\n{schema['description']}\n\n{_table(schema)}"
    yield from _within(path, schema, definitions)


def _within(path: str, schema: Schema, definitions: dict[str, Schema]) -> Iterator[str]:
    """The tables in a table."""
    for key, place in schema["properties"].items():
        title = f"[[{path}.{key}]]" if place.get("type") == "array" else f"[{path}.{key}]"
        if _union(place):
            yield from _sections_by_type(title, f"{path}.{key}", place, definitions)
        elif target := _target(place):
            yield from _section(title, f"{path}.{key}", target, definitions)


def _parts() -> Iterator[str]:
    for entry in Registry.load().entries:
        schema = entry.part.Options.model_json_schema()
        if entry.origin.startswith("rigidfluid ") and schema["properties"]:
            meaning = " ".join(schema["description"].replace("``", "`").split())
            yield f"## `{_named(entry)}`\n\n{meaning}\n\n{_table(schema)}"
            yield from _within(entry.kind.field.rpartition(".")[0], schema, schema.get("$defs", {}))


def _named(entry: Entry) -> str:
    table, _, key = entry.kind.field.rpartition(".")
    if entry.kind.field == "contact.law":
        table = "[contact] or [[interaction]]"
    else:
        table = f"[[{table}]]" if table in ("body", "joint", "mesh.field") else f"[{table}]"
    return f'{table} {key} = "{entry.name}"'


def _table(schema: Schema) -> str:
    rows = ["| key | type | unit | default | meaning |", "|---|---|---|---|---|"]
    for key, field in schema["properties"].items():
        meaning, unit = re.fullmatch(r"(.*?)(?: \[([^]]*)\])?", field.get("description", "")).groups()
        default = "required" if key in schema.get("required", ()) else _default(field)
        rows.append(f"| `{key}` | {_type(field)} | {unit or ''} | {default} | {meaning} |")
    return "\n".join(rows) + "\n"


def _default(field: Schema) -> str:
    return "" if field.get("default") in (None, "") else f"`{json.dumps(field['default'])}`"


def _type(field: Schema) -> str:
    if "const" in field:
        return f"`{json.dumps(field['const'])}`"
    if "enum" in field:
        return ", ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    if _union(field):
        return "table"
    if "anyOf" in field:
        return " or ".join(_type(one) for one in field["anyOf"] if one.get("type") != "null")
    if field.get("type") == "array":
        entry = _type(field.get("items") or field["prefixItems"][0])
        return f"list of {entry.replace('list', 'lists')}" + ("" if entry.endswith("s") else "s")
    return "table" if "$ref" in field or field["type"] == "object" else str(field["type"])


def _union(field: Schema) -> Schema:
    """The tables, told apart by a key, of a field or a list's entry; empty for any other."""
    return next((one for one in (field, field.get("items", {}), *field.get("anyOf", ())) if "oneOf" in one), {})


def _target(field: Schema) -> str:
    """Name of the model that a field, or a list's entry, refers to; empty for a plain value."""
    for one in (field, field.get("items", {}), *field.get("anyOf", ()), *field.get("allOf", ())):
        if "$ref" in one:
            return str(one["$ref"]).rpartition("/")[2]
    return ""


if __name__ == "__main__":
    PATH.write_text(reference(), encoding="utf-8")
