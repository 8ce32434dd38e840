"""Base classes of the tables of a scene file, and types that keys of many tables have.

The description of each key ends with its unit in brackets where it has one; the scene reference is made from it. Units
are free but must be consistent; ``d`` is the dimension.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from rigidfluid.core.scene.table_type import TableType

Positive = Annotated[float, Field(gt=0)]


class Table(BaseModel, metaclass=TableType):
    """A table whose keys are all given here."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


class OpenTable(Table):
    """A table that also holds the keys of the part it names; `rigidfluid.core.case` validates those."""

    model_config = ConfigDict(extra="allow")

    @property
    def options(self) -> dict[str, Any]:
        """The keys that belong to the part."""
        return dict(self.model_extra or {})
