"""Refuses keys of `[contact]` that contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

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
