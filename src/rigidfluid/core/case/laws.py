"""Laws that a scene names, one in `[contact]` and one in each `[[interaction]]`: of contact, and long-range ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from rigidfluid.core.model.force_law import Between, ForceLaw
from rigidfluid.core.model.pose_law import PoseLaw
from rigidfluid.core.model.selected import Selected
from rigidfluid.core.nested.part_options import own_options, refuse_unread
from rigidfluid.core.scene.contact_tables import ContactTable, InteractionTable
from rigidfluid.core.setup.contact_laws import MAY_BE_OWN, ContactLaw, is_own
from rigidfluid.core.setup.pair_forces import PairForce
from rigidfluid.errors import SceneError
from rigidfluid.registry import DETECTOR, FORCE_LAW, Registry


class _LawTable(NamedTuple):
    """A table that names a law, with its ``field`` in the scene, its place among contacts, and the keys of its part."""

    field: str
    table: ContactTable | InteractionTable
    between: Between
    names: tuple[str, ...]


def scene_laws(contact: ContactTable, interactions: Sequence[InteractionTable], registry: Registry) -> list[ContactLaw]:
    """All laws of contact of a scene, that of `[contact]` first; raises PluginError for one that is missing, SceneError
    for an option that is not allowed."""
    found = []
    for (field, table, between, names), part in _named_laws(contact, interactions, registry):
        assert table.range is not None
        if issubclass(part, PoseLaw):
            continue
        others = registry.installed(DETECTOR) if isinstance(table, ContactTable) else []
        refuse_unread(table.options, [part, *others], type(table).model_fields, field)
        common = {key: getattr(table, key) for key in MAY_BE_OWN if getattr(table, key) is not None}
        own = {key: value for key, value in common.items() if is_own(key, part)}
        options = own_options(part, {**table.options, **own}, field)
        found.append(
            ContactLaw(
                law=Selected[ForceLaw](part, options),
                range=table.range,
                smallest_gap=table.smallest_gap,
                **common,
                restitution_stokes=table.restitution_stokes,
                roughness=table.roughness,
                between=between,
                names=names,
                field=field,
            )
        )
    return found


def scene_pair_forces(
    contact: ContactTable, interactions: Sequence[InteractionTable], registry: Registry
) -> list[PairForce]:
    """All long-range forces of a scene; raises as `scene_laws` does, also for a table without two names, and for keys
    of laws of contact."""
    found = []
    for (field, table, _, names), part in _named_laws(contact, interactions, registry):
        assert table.range is not None
        if issubclass(part, PoseLaw):
            _refuse_keys_of_contact(table, part, field)
            if len(names) != 2:
                allowed = f"the names of two bodies with {part.name!r}, in [[interaction]]"
                raise SceneError(f"{field}.names", list(names) or "none", allowed, "Add a table for each pair.")
            refuse_unread(table.options, [part], type(table).model_fields, field)
            options = own_options(part, table.options, field)
            found.append(PairForce(Selected[PoseLaw](part, options), table.range, names, field))
    return found


def _refuse_keys_of_contact(table: ContactTable | InteractionTable, part: type[PoseLaw], field: str) -> None:
    for key in ("smallest_gap", *MAY_BE_OWN, "restitution_stokes", "roughness"):
        if getattr(table, key) is not None:
            allowed = f"a law of contact, which {part.name!r} is not"
            raise SceneError(f"{field}.{key}", getattr(table, key), allowed, "Remove it, or choose another law.")
    if isinstance(table, InteractionTable) and table.between == "walls":
        raise SceneError(f"{field}.between", "walls", f"pairs, where {part.name!r} acts", "Leave it out.")


def _named_laws(
    contact: ContactTable, interactions: Sequence[InteractionTable], registry: Registry
) -> Iterator[tuple[_LawTable, type[ForceLaw]]]:
    """Tables that name a law, each with its class; raises PluginError for one that is missing."""
    for entry in _law_tables(contact, interactions):
        assert entry.table.law is not None
        yield entry, registry.get(FORCE_LAW, entry.table.law, f"{entry.field}.law")


def _law_tables(contact: ContactTable, interactions: Sequence[InteractionTable]) -> Iterator[_LawTable]:
    if contact.law is not None and contact.range is not None:
        yield _LawTable("contact", contact, "all", ())
    for number, table in enumerate(interactions):
        yield _LawTable(f"interaction.{number}", table, table.between, table.names or ())
