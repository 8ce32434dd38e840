"""Quantities that keys of a scene hold, by their descriptions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from rigidfluid.core.case.part_tables import PART_TABLES
from rigidfluid.core.scene.quantity import described_quantity
from rigidfluid.core.scene.validation import fields_by_key
from rigidfluid.registry import Registry


def key_quantity(scene: BaseModel, key: str) -> str:
    """Quantity of a scene's key ("body.0.density"), as "mass/length^d"; empty where it has none."""
    described = list(_descriptions(scene, key))
    return described_quantity(described[-1]) if described else ""


def _descriptions(scene: BaseModel, key: str) -> Iterator[str]:
    """Descriptions of the keys of a table that a dotted key leads through, a part's own among them."""
    value: Any = scene
    for word in key.split("."):
        if isinstance(value, BaseModel):
            fields = fields_by_key(type(value)) | _fields_of_part(value)
            if word not in fields:
                return
            yield fields[word].description or ""
            value = getattr(value, word, None)
        elif isinstance(value, tuple) and word.isdecimal() and int(word) < len(value):
            value = value[int(word)]


def _fields_of_part(table: BaseModel) -> dict[str, Any]:
    """Keys of the parts that a table names."""
    registry = Registry.load()
    found: dict[str, Any] = {}
    for _, kind, model in PART_TABLES:
        name = getattr(table, kind.key, None) if type(table) is model else None
        if name in registry.names(kind):
            found |= fields_by_key(registry.find(kind, name).Options)
    return found
