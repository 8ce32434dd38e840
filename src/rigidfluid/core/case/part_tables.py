"""Checks the keys of parts in tables that may be refused for other reasons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rigidfluid.core.model.interfaces import Part
from rigidfluid.core.nested.part_options import own_options, read_options
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.scene import (
    BodyTable,
    DomainTable,
    FluidTable,
    InteractionTable,
    JointTable,
    MechanismTable,
    SizeFieldTable,
)
from rigidfluid.core.scene.validation import fields_by_key
from rigidfluid.registry import (
    BODY,
    DETECTOR,
    DOMAIN,
    FLUID_BACKEND,
    FORCE_LAW,
    JOINT,
    MECHANISM,
    SIZE_FIELD,
    Kind,
    Registry,
)

_NAMED: tuple[tuple[str, str, Kind[Any], Any], ...] = (
    ("fluid", "backend", FLUID_BACKEND, FluidTable),
    ("domain", "type", DOMAIN, DomainTable),
    ("body", "type", BODY, BodyTable),
    ("mechanism", "type", MECHANISM, MechanismTable),
    ("joint", "type", JOINT, JointTable),
    ("contact", "detector", DETECTOR, None),
    ("contact", "law", FORCE_LAW, None),
    ("interaction", "law", FORCE_LAW, InteractionTable),
    ("mesh.field", "type", SIZE_FIELD, SizeFieldTable),
)
"""Places of tables that name a part, the key that does it, the part's kind, and the table's own keys; none where
several parts have keys in one table."""


def check_part_tables(data: Mapping[str, Any], registry: Registry) -> None:
    """Raise SceneError or PluginError for parts that are not there, and for keys that parts do not know or refuse."""
    with all_told() as ask:
        for place, key, kind, model in _NAMED:
            for at, table in _tables(data, place):
                name = table.get(key, model.model_fields[key].default if model else None)
                if isinstance(name, str) and name != "auto":
                    part = ask(registry.find, kind, name, f"{at}.{key}")
                    if part is not None:
                        ask(_check_table, part, at, table, model)


def _check_table(part: type[Part], at: str, table: Mapping[str, Any], model: Any) -> None:
    if model is None:
        own_options(part, table, at)
    else:
        own = fields_by_key(model)
        read_options(part, {key: table[key] for key in table if key not in own}, own, at)


def _tables(data: Mapping[str, Any], place: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """All tables at a place of a scene, each with its field."""
    found: Any = data
    for key in place.split("."):
        found = found.get(key) if isinstance(found, Mapping) else None
    entries = [(place, found)] if isinstance(found, Mapping) else []
    if isinstance(found, list):
        entries = [(f"{place}.{number}", entry) for number, entry in enumerate(found)]
    yield from ((at, table) for at, table in entries if isinstance(table, Mapping))
