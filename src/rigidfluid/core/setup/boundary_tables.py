"""Tables of conditions, put on the pieces of the domain's boundary that they name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.piece import Piece
from rigidfluid.core.model.types import FloatArray
from rigidfluid.core.scene.scene import BoundaryTable, WallTable

if TYPE_CHECKING:
    from rigidfluid.core.scene.scene import Scene

_UNNAMED = WallTable(on="all", type="wall")
"""Table of pieces that a scene does not name."""


@dataclass(frozen=True)
class Place:
    """Place of a condition: a ``piece`` of the boundary in so many dimensions, and its number ``surface``.

    ``image``: the number of the opposite surface, where it is the first of a periodic pair. ``at``: the key of its
    table.
    """

    piece: Piece
    dimension: int
    surface: int
    image: int | None
    at: str

    @property
    def surface_name_normal(self) -> tuple[int, str, FloatArray | None]:
        """The first three fields of every condition."""
        return self.surface, self.piece.name, self.normal

    @property
    def normal(self) -> FloatArray | None:
        """Unit normal into the fluid (d,); None where the piece is not flat."""
        plane = self.piece.shape.plane
        return None if plane is None else plane.unit_normal

    @property
    def across_an_axis(self) -> bool:
        """Whether the piece is flat and lies across an axis."""
        plane = self.piece.shape.plane
        return plane is not None and plane.axis is not None


def placed_tables(scene: Scene, domain: Domain) -> Iterator[tuple[BoundaryTable, Place]]:
    """The last table for each piece of the boundary, in the order of surface numbers; a wall at rest without any."""
    bodies, opposite = len(scene.body), dict(domain.periodic)
    for number, piece in enumerate(domain.pieces):
        tables = [(f"boundary.{i}", table) for i, table in enumerate(scene.boundary) if table.on in (piece.name, "all")]
        at, table = tables[-1] if tables else ("boundary", _UNNAMED)
        image = bodies + opposite[number] if number in opposite else None
        yield table, Place(piece, domain.dimension, bodies + number, image, at)


def tables_of_walls(scene: Scene, domain: Domain) -> Iterator[tuple[WallTable, Place]]:
    """Tables of the pieces that are walls, which repel bodies."""
    for table, place in placed_tables(scene, domain):
        if isinstance(table, WallTable):
            yield table, place
