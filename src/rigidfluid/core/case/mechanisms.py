"""A scene's mechanisms: found and built."""

from __future__ import annotations

from collections.abc import Sequence

from rigidfluid.core.case.table_values import values_of
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.nested.part_options import build_part, told_at
from rigidfluid.core.scene.body_tables import MechanismTable
from rigidfluid.core.setup.rigid_body import PlacedMechanism
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
    mechanism = build_part(MECHANISM, table, at, registry, dimension)
    with told_at(at):
        mechanism.components  # noqa: B018  it may be there that it refuses its options
    return mechanism
