"""A named piece of the domain's boundary."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Surface


@dataclass(frozen=True)
class Piece:
    """A piece of the domain's boundary that conditions can be set on by its name.

    ``shape``: the surface it lies on; of a flat piece all of its plane, if that does not go on inside. ``area`` of the
    piece [length^(d-1)]. ``coordinates``: from points (N, d) of the piece to its own coordinates (N, d-1), each from 0
    to 1 and with equal areas for equal parts; profiles are given in them, and a piece without them has none.
    ``other_name``: by which tables of a scene may name it too, None if there is none.
    """

    name: str
    shape: Surface
    area: float
    coordinates: Callable[[FloatArray], FloatArray] | None = None
    other_name: str | None = None

    @property
    def all_names(self) -> tuple[str, ...]:
        """Its name, and its other name if it has one."""
        return (self.name,) if self.other_name is None else (self.name, self.other_name)

    @property
    def names_in_words(self) -> str:
        """Its names, for a message."""
        return " or ".join(self.all_names)


def all_names(pieces: Iterable[Piece]) -> list[str]:
    """Names and other names of ``pieces``, in their order."""
    return [name for piece in pieces for name in piece.all_names]
