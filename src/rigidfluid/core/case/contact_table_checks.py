"""Refuses keys of `[contact]` that contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rigidfluid.core.scene.numbered_names import ANY, stands_for
from rigidfluid.core.scene.spelling import suggestion
from rigidfluid.core.setup.contact_laws import MAY_BE_OWN
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.scene.contact_tables import ContactTable, InteractionTable


def check_contact_table(table: ContactTable, interactions: Sequence[InteractionTable]) -> None:
    """Refuse, with SceneError, keys of a law where no law is named, and contradictions."""
    law, range_ = table.law, table.range
    if law is not None and range_ is None:
        raise SceneError("contact.range", "nothing", "a length above 0 with `law`", "Add the law's reach.")
    if law is None and range_ is not None:
        raise SceneError("contact.range", f"{range_} without a law", "`range` with `law`", "Name the law: `law = …`.")
    own = dict.fromkeys(("smallest_gap", *MAY_BE_OWN, "restitution_stokes", "roughness"), law)
    for key, read in {**own, "impact_speed": law or interactions}.items():
        given = getattr(table, key)
        if not read and given is not None:
            remedy = "Name the law: `law = …`."
            raise SceneError(f"contact.{key}", f"{given} without a law", f"`{key}` with `law`", remedy)


def check_numbered_names(
    interactions: Sequence[InteractionTable], bodies: Sequence[str], sources: Sequence[str]
) -> None:
    """Refuse, with SceneError, names with a number each that none of the ``bodies`` has, and that no source gives."""
    for row, table in enumerate(interactions):
        for number, named in enumerate(table.names or ()):
            known = any(stands_for(named, name) for name in bodies) or named.removesuffix(ANY) in sources
            if named.endswith(ANY) and not known:
                field, allowed = f"interaction.{row}.names.{number}", "the beginning of names of a swarm or a source"
                remedy = suggestion(named, [f"{name}{ANY}" for name in sources]) or "Correct the name."
                raise SceneError(field, repr(named), allowed, remedy)
