"""Parts of their tables: their options among the keys, and how they are built."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, TypeVar

from pydantic import BaseModel

from rigidfluid.core.model.interfaces import Part, PartOptions, SpatialPart
from rigidfluid.core.scene.scene import BodyTable, SizeFieldTable
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.errors import SceneError
from rigidfluid.registry import Kind, Registry

S = TypeVar("S", bound=SpatialPart)


def values_of(table: BaseModel, kind: type[Any], part: str) -> dict[str, Any]:
    """Values of the fields of a ``kind`` of the model's dataclasses, from a table with keys of the same names; all but
    its ``part``."""
    return {field.name: getattr(table, field.name) for field in fields(kind) if field.name != part}


def own_options(part: type[Part], given: Mapping[str, Any], at: str) -> PartOptions:
    """The part's own of the keys given; ``at`` is the place of their table in the scene."""
    own = fields_by_key(part.Options)
    return read_table(part.Options, {key: given[key] for key in given if key in own}, at)


def refuse_unread(
    options: Mapping[str, Any], readers: Sequence[type[Part]], common: Mapping[str, Any], at: str, hint: str = ""
) -> None:
    """Raise SceneError for a key that none of the ``readers`` has, and that is not ``common`` to all such tables."""
    known = set().union(*(fields_by_key(reader.Options) for reader in readers))
    for key in options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", known | set(common), hint)


def build_part(kind: Kind[S], table: BodyTable | SizeFieldTable, at: str, registry: Registry, dimension: int) -> S:
    """Part of a kind that a table in a list of the scene names, at the place ``at`` (``body.0``).

    Raises PluginError if it is missing, SceneError for an option that is unknown or refused.
    """
    part = registry.get(kind, table.type, f"{at}.type")
    refuse_unread(table.options, [part], type(table).model_fields, at)
    options = read_table(part.Options, table.options, at)
    try:
        return part(options, dimension)
    except SceneError as error:  # a part does not know its number
        own_key = error.subject.removeprefix(f"{at.rpartition('.')[0]}.")
        raise SceneError(f"{at}.{own_key}", error.found, error.allowed, error.remedy) from None
