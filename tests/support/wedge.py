"""A triangle with one side that lies across no axis."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.part import PartOptions

CORNERS = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]])


class Wedge(Domain):
    """{x > 0, y > 0, x/2 + y < 1}."""

    name = "wedge"
    Options = PartOptions

    @property
    def pieces(self) -> tuple[Piece, ...]:
        return self._side("floor", 0, 1), self._side("slope", 1, 2), self._side("side", 2, 0)

    @property
    def extent(self) -> tuple[FloatArray, FloatArray]:
        return CORNERS.min(axis=0), CORNERS.max(axis=0)

    @property
    def volume(self) -> float:
        return 1.0

    def contains(self, points: FloatArray) -> BoolArray:
        return np.all([piece.shape.signed_distance(points) > 0.0 for piece in self.pieces], axis=0)

    def cad_shape(self, unit: float) -> Any:
        from netgen import occ

        corners = CORNERS / unit
        path = occ.WorkPlane().MoveTo(*corners[0])
        for name, corner in zip(("floor", "slope", "side"), np.roll(corners, -1, axis=0), strict=True):
            path = path.LineTo(*corner, name)
        return path.Face()

    def _side(self, name: str, first: int, second: int) -> Piece:
        start, end = CORNERS[first], CORNERS[second]
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        corners = np.minimum(start, end), np.maximum(start, end)
        return Piece(name, Plane(start, np.array([-along[1], along[0]]), corners), length)


def wedge() -> Wedge:
    return Wedge(PartOptions(), 2)
