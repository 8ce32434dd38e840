"""A box with obstacles in it."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

from pydantic import Field

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interfaces import PartOptions
from rigidfluid.core.model.piece import Piece
from rigidfluid.core.model.types import BoolArray, FloatArray
from rigidfluid.core.setup.nested_bodies import NestedBodyTable
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.domains.obstacles import AT, placed_obstacles, refuse_overlap
from rigidfluid.errors import SceneError


class ChannelOptions(BoxOptions):
    """Keys of the ``[domain]`` table with type ``channel``: the box from ``lower`` to ``upper``, and in each table
    ``[[domain.obstacle]]`` a body of any type that stays where it is, with a surface of its own.

    The faces of the box are called ``left`` and ``right`` along x, ``bottom`` and ``top`` along y, ``back`` and
    ``front`` along z.
    """

    obstacle: tuple[NestedBodyTable, ...] = Field(
        default=(), description="`name`, `type`, `position`, `angle` or `orientation`, and the keys of the type"
    )


class Channel(Domain):
    """{x : lower < x < upper} \\ ∪ K_i with obstacles K_i, of volume ∏ (upper - lower) - Σ |K_i|.

    Impossible boxes or obstacles, two of one name, and overlaps raise SceneError.
    """

    name: ClassVar[str] = "channel"
    Options: ClassVar[type[PartOptions]] = ChannelOptions
    options: ChannelOptions

    def __init__(self, options: ChannelOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self._box = Box(BoxOptions(lower=options.lower, upper=options.upper), dimension)
        self._obstacles = placed_obstacles(options.obstacle, dimension)
        for number, name in enumerate(self._obstacles):
            if name in (taken := ("all", *self._box.names)):
                allowed = f"a name other than {', '.join(taken)}"
                raise SceneError(f"{AT}.{number}.name", repr(name), allowed, "Rename it.")
        self._refuse_outside()
        refuse_overlap(self._obstacles, self._box.pieces)

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """The faces of the box, then the obstacles in the scene's order."""
        obstacles = (Piece(name, placed.surface, placed.area) for name, placed in self._obstacles.items())
        return (*self._box.pieces, *obstacles)

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        """The corners of the box [length]."""
        return self._box.extent

    @property
    def volume(self) -> float:
        """Volume of the box without the obstacles [length^d]."""
        return self._box.volume - sum(placed.shape.volume for placed in self._obstacles.values())

    def contains(self, points: FloatArray) -> BoolArray:
        """Which of ``points`` (N, d) are in the box and in no obstacle, (N,)."""
        inside = self._box.contains(points)
        for placed in self._obstacles.values():
            inside &= placed.signed_distance(points) > 0.0
        return inside

    def cad_shape(self, unit: float) -> Any:
        """The box minus the obstacles, as a ``netgen.occ`` face or solid with lengths over ``unit``."""
        shape = self._box.cad_shape(unit)
        for name, placed in self._obstacles.items():
            shape = shape - placed.cad_shape(name, unit)
        return shape

    def _refuse_outside(self) -> None:
        """A centre beyond a face overlaps it by more than a detector need see."""
        for number, placed in enumerate(self._obstacles.values()):
            if not self._box.contains(placed.pose.position).all():
                lower, upper = (corner.tolist() for corner in self.extent)
                allowed = f"inside the box from {lower} to {upper}"
                found = placed.pose.position[0].tolist()
                raise SceneError(f"{AT}.{number}.position", found, allowed, "Move it.")
