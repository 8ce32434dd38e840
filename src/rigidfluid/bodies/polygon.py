"""A polygon: any shape in the plane with straight edges."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.bodies.facet_body import FacetBody
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError

Point = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]

_SHORTEST_EDGE = 1e-9
"""Least length of an edge over the size of the polygon [1]."""

_FOLDED = 1e-9
"""Sine of the angle at a corner that goes straight back."""


class PolygonOptions(PartOptions):
    """Keys of a ``[[body]]`` table of type ``polygon``: ``points``, its corners in order [length]."""

    points: tuple[Point, ...] = Field(
        min_length=3,
        description="Corners [x, y] in order, clockwise or counter-clockwise, in any frame: the centre of mass is "
        "placed at `position`, and `angle` rotates the body about it [length]",
    )


class Polygon(FacetBody):
    """The inside of a closed line through its corners, convex or not; mass and inertia are exact.

    Parameters
    ----------
    options : PolygonOptions
        ``points``, the corners in any frame [length].
    dimension : int
        2.

    Raises
    ------
    SceneError
        If the dimension is 3, corners coincide, or the line crosses itself, folds back or encloses nothing.
    """

    name: ClassVar[str] = "polygon"
    also_called: ClassVar[tuple[str, ...]] = ("rectangle", "square", "triangle")
    Options: ClassVar[type[PartOptions]] = PolygonOptions
    options: PolygonOptions

    def __init__(self, options: PolygonOptions, dimension: int) -> None:
        if dimension != 2:
            remedy = 'In 3D bodies of facets are of type "stl".'
            raise SceneError("body.type", '"polygon" in 3D', "polygons in 2D", remedy)
        corners = np.array(options.points)
        _refuse_short_and_folded(corners)
        numbers = np.arange(len(corners))
        edges = np.stack([numbers, np.roll(numbers, -1)], axis=1)
        super().__init__(options, Facets(corners, edges, np.zeros(len(corners), dtype=np.int64)), "points")

    def cad_shape(self, unit: float) -> Any:
        """A face in the plane z = 0 with straight edges, as a ``netgen.occ`` shape with lengths over ``unit``."""
        from netgen import occ

        corners = in_unit(self.facets.points[self.facets.vertices[:, 0]], unit).tolist()
        plane = occ.WorkPlane().MoveTo(*corners[0])
        for corner in corners[1:]:
            plane = plane.LineTo(*corner)
        return plane.Close().Face()


def _refuse_short_and_folded(corners: np.ndarray) -> None:
    ahead = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(ahead, axis=1)
    short = np.flatnonzero(~(length > _SHORTEST_EDGE * np.ptp(corners, axis=0).max()))
    if len(short):
        k = int(short[0])
        found = f"corners {k} and {(k + 1) % len(corners)} at the same place, {corners[k].tolist()}"
        raise SceneError("body.points", found, "each corner once", "Leave one of them out; the last joins the first.")
    along = ahead / length[:, None]
    before = np.roll(along, 1, axis=0)
    turn = before[:, 0] * along[:, 1] - before[:, 1] * along[:, 0]
    folded = np.flatnonzero((np.abs(turn) < _FOLDED) & (np.sum(before * along, axis=1) < 0))
    if len(folded):
        found = f"a line that goes straight back at corner {folded[0]}, {corners[folded[0]].tolist()}"
        raise SceneError("body.points", found, "corners that open to some angle", "Leave this corner out.")
