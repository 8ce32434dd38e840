"""A scene's mechanisms: found and built."""

from __future__ import annotations

from collections.abc import Sequence

from rigidfluid.core.case.part_options import values_of
from rigidfluid.core.model.interfaces import Mechanism
from rigidfluid.core.scene.scene import MechanismTable
from rigidfluid.core.scene.validation import fields_by_key, read_table, unknown_key
from rigidfluid.core.setup.rigid_body import PlacedMechanism
from rigidfluid.errors import PluginError, SceneError
from rigidfluid.registry import MECHANISM, Registry


def placed_mechanisms(
    tables: Sequence[MechanismTable], registry: Registry, dimension: int
) -> tuple[PlacedMechanism, ...]:
    """Mechanisms of a scene in their places.

    Raises PluginError for a mechanism that is missing or invalid, SceneError for a refused option.
    """
    return tuple(
        PlacedMechanism(
            mechanism=_built(table, registry, dimension, f"mechanism.{number}"),
            **values_of(table, PlacedMechanism, "mechanism"),
        )
        for number, table in enumerate(tables)
    )


def _built(table: MechanismTable, registry: Registry, dimension: int, at: str) -> Mechanism:
    part = registry.get(MECHANISM, table.type, f"{at}.type")
    known = fields_by_key(part.Options)
    for key in table.options:
        if key not in known:
            raise unknown_key(f"{at}.{key}", {*known, *type(table).model_fields})
    options = read_table(part.Options, table.options, at)
    try:
        mechanism = part(options, dimension)
        mechanism.components  # noqa: B018  it may be there that it refuses its options
    except (SceneError, PluginError) as error:  # a mechanism does not know its number
        subject = f"{at}.{error.subject.partition('.')[2]}"
        raise type(error)(subject, error.found, error.allowed, error.remedy) from None
    return mechanism
