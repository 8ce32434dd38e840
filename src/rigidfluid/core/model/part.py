"""Base classes of replaceable parts and of their options.

Every part names itself (``name``), the packages it needs (``requires``: import name → what to install) and the keys it
reads from its table of the scene file (``Options``). Importing the class must not import those packages.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from pydantic import BaseModel, ConfigDict

from rigidfluid.core.geometry.guarded import Guarded
from rigidfluid.core.scene.table_type import TableType


class PartOptions(BaseModel, metaclass=TableType):
    """The keys that an implementation reads from its table of the scene file; this one reads none."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True)


class Part(metaclass=Guarded):
    """Replaceable part: its name, other words for it, the packages it requires and its options.

    A ``kind`` of parts says with `gives` what its methods give; whoever gives anything else is named.
    """

    kind: ClassVar[str]
    name: ClassVar[str]
    also_called: ClassVar[tuple[str, ...]] = ()
    requires: ClassVar[Mapping[str, str]] = {}
    Options: ClassVar[type[PartOptions]] = PartOptions


class SpatialPart(Part):
    """A part of so many space dimensions, with the options that its table gives it."""

    dimension: int

    def __init__(self, options: PartOptions, dimension: int) -> None:
        self.options = options
        self.dimension = dimension
