"""A part that has been chosen: its class, and the options that it is to be made with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from rigidfluid.core.model.part import Part, PartOptions

P = TypeVar("P", bound=Part)


@dataclass(frozen=True)
class Selected(Generic[P]):
    """A class of a part, whether a plug-in registers it or not, and its validated options."""

    part: type[P]
    options: PartOptions
