"""Tables of a study file, whose keys are all known."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict

Settings = dict[str, Any]
"""Values by dotted key of the scene."""


class StrictTable(BaseModel):
    """A table whose keys are all given here."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


def flat(value: Any, whole: frozenset[str] = frozenset()) -> Any:
    """``{"mesh": {"size": x}}`` as ``{"mesh.size": x}``, as TOML reads a bare dotted key as tables; a table with one of
    the keys ``whole`` is a value."""
    if not isinstance(value, Mapping):
        return value
    found: Settings = {}
    for key, part in value.items():
        opened = isinstance(part, Mapping) and not whole & set(part)
        found |= {f"{key}.{rest}": leaf for rest, leaf in flat(part, whole).items()} if opened else {key: part}
    return found
