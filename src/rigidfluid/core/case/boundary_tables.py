"""Tables of conditions, put on the pieces of the domain's boundary that they name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.scene.boundary_tables import BoundaryTable, WallTable

_UNNAMED = WallTable(on="all", type="wall")
"""Table of pieces that a scene does not name."""


@dataclass(frozen=True)
class Place:
    """Place of a condition: a ``piece`` of the boundary in so many dimensions; ``at``: the key of its table."""

    piece: Piece
    dimension: int
    at: str


def placed_tables(tables: Sequence[BoundaryTable], domain: Domain) -> Iterator[tuple[BoundaryTable, Place]]:
    """The last table for each piece of the boundary, in the order of surface numbers; a wall at rest without any."""
    for piece in domain.pieces:
        on = [(f"boundary.{i}", table) for i, table in enumerate(tables) if table.on in (*piece.all_names, "all")]
        at, table = on[-1] if on else ("boundary", _UNNAMED)
        yield table, Place(piece, domain.dimension, at)
