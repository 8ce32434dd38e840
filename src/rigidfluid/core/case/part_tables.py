"""Checks the keys of parts in tables that may be refused for other reasons."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from rigidfluid.core.model.part import Part
from rigidfluid.core.nested.part_options import own_options, read_options, refuse_unread
from rigidfluid.core.scene.all_errors import all_told
from rigidfluid.core.scene.body_tables import BodyTable, MechanismTable
from rigidfluid.core.scene.contact_tables import ContactTable, InteractionTable
from rigidfluid.core.scene.domain_table import DomainTable
from rigidfluid.core.scene.fluid_table import FluidTable, MaterialTable
from rigidfluid.core.scene.joint_tables import JointTable
from rigidfluid.core.scene.mesh_tables import SizeFieldTable
from rigidfluid.core.scene.swarm_tables import SwarmShapeTable
from rigidfluid.core.scene.validation import fields_by_key
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
    Kind,
    Registry,
)

PART_TABLES: tuple[tuple[str, Kind[Any], Any], ...] = (
    ("fluid", FLUID_BACKEND, FluidTable),
    ("body", BODY, BodyTable),
    ("swarm.shape", BODY, SwarmShapeTable),
    ("source.shape", BODY, SwarmShapeTable),
    ("mechanism", MECHANISM, MechanismTable),
    ("contact", DETECTOR, ContactTable),
    ("contact", FORCE_LAW, ContactTable),
    ("interaction", FORCE_LAW, InteractionTable),
    ("domain", DOMAIN, DomainTable),
    ("joint", JOINT, JointTable),
    ("mesh.field", SIZE_FIELD, SizeFieldTable),
    ("fluid.material", MATERIAL, MaterialTable),
)
"""Places of tables that name a part, the part's kind, and the model of the table's own keys."""


def check_part_tables(data: Mapping[str, Any], registry: Registry) -> None:
    """Raise SceneError or PluginError for parts that are not there, and for keys that parts do not know or refuse."""
    with all_told() as ask:
        for place, kind, model in PART_TABLES:
            for at, table in _tables(data, place):
                name = table.get(kind.key, model.model_fields[kind.key].default)
                if isinstance(name, str) and name != "auto":
                    part = ask(registry.find, kind, name, f"{at}.{kind.key}")
                    if part is not None:
                        ask(_check_table, part, at, table, model)
                    elif model is not ContactTable:
                        ask(refuse_unread, _options(table, model), registry.installed(kind), fields_by_key(model), at)


def _check_table(part: type[Part], at: str, table: Mapping[str, Any], model: Any) -> None:
    if model is ContactTable:  # others have keys there, too
        own_options(part, table, at)
    else:
        read_options(part, _options(table, model), fields_by_key(model), at)


def _options(table: Mapping[str, Any], model: Any) -> dict[str, Any]:
    """The keys that belong to the part."""
    own = fields_by_key(model)
    return {key: table[key] for key in table if key not in own}


def _tables(data: Mapping[str, Any], place: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """All tables at a place of a scene, also in tables of lists, each with its field."""
    found: list[tuple[str, Any]] = [("", data)]
    for key in place.split("."):
        inside = [(f"{at}.{key}" if at else key, table.get(key)) for at, table in found if isinstance(table, Mapping)]
        found = [one for at, value in inside for one in _entries(at, value)]
    yield from ((at, table) for at, table in found if isinstance(table, Mapping))


def _entries(at: str, value: Any) -> list[tuple[str, Any]]:
    """A value, or the entries of a list, each with its field."""
    return [(f"{at}.{n}", entry) for n, entry in enumerate(value)] if isinstance(value, list) else [(at, value)]
