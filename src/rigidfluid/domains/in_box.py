"""A domain that is what others leave of a box."""

from __future__ import annotations

from collections.abc import Collection
from copy import copy
from typing import Self

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.domain import Domain
from rigidfluid.domains.box import Box


class InBox(Domain):
    """A part of a box, whose faces are among its surfaces."""

    _box: Box

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """The corners of the box [length]."""
        return self._box.extent

    def called(self, names: Collection[str]) -> Self:
        """The same domain with faces called ``xmin`` … ``zmax`` where these are among the ``names``."""
        other = copy(self)
        other._box = self._box.called(names)
        vars(other).pop("pieces", None)  # they were kept under other names
        return other
