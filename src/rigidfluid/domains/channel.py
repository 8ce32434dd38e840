"""A box with obstacles in it."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

from pydantic import Field

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.nested.bodies import NestedBodyTable
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.in_box import InBox
from rigidfluid.domains.obstacles import Obstacles


class ChannelOptions(BoxOptions):
    """Keys of the ``[domain]`` table with type ``channel``: the box from ``lower`` to ``upper``, and in each table
    ``[[domain.obstacle]]`` a fixed body of any type, with a surface of its own.

    The faces of the box are called ``left`` and ``right`` along x, ``bottom`` and ``top`` along y, ``back`` and
    ``front`` along z, or ``xmin``, ``xmax``, ``ymin``, ``ymax``, ``zmin`` and ``zmax``.
    """

    obstacle: tuple[NestedBodyTable, ...] = Field(
        default=(), description="`name`, `type`, `position`, `angle` or `orientation`, and the keys of the type"
    )


class Channel(InBox):
    """{x : lower < x < upper} \\ ∪ K_i with obstacles K_i, of volume ∏ (upper - lower) - Σ |K_i|.

    Impossible boxes or obstacles, two of one name, and overlaps raise SceneError.
    """

    name: ClassVar[str] = "channel"
    Options: ClassVar[type[PartOptions]] = ChannelOptions
    options: ChannelOptions

    def __init__(self, options: ChannelOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self._box = Box(BoxOptions(lower=options.lower, upper=options.upper), dimension)
        self._obstacles = Obstacles(options.obstacle, self._box, "domain.obstacle")

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The faces of the box, then the obstacles in the scene's order."""
        return (*self._box.pieces, *self._obstacles.pieces)

    @property
    def volume(self) -> float:
        """Volume of the box without the obstacles [length^d]."""
        return self._box.volume - self._obstacles.volume

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are in the box and in no obstacle, (N,)."""
        return self._box.contains(points) & ~self._obstacles.hold(points)

    def cad_shape(self, unit: float) -> Any:
        """The box minus the obstacles, as a ``netgen.occ`` face or solid with lengths over ``unit``."""
        return self._obstacles.cut_from(self._box.cad_shape(unit), unit)
