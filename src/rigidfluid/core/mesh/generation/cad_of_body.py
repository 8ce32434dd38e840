"""Bodies as CAD shapes, so that they can be taken out of others: polygons and polyhedra by their facets."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.mesher_unit import in_space, in_unit
from rigidfluid.core.model.body import Body


def cad_of_body(body: Body, unit: float) -> Any:
    """A ``netgen.occ`` face (2D) or solid (3D) of a body in its own frame, lengths over ``unit``."""
    return body.cad_shape(unit) if body.facets is None else _cad_of_facets(body.facets, unit)


def _cad_of_facets(facets: Facets, unit: float) -> Any:
    """A face (2D) or solid (3D) with the corners of one closed surface."""
    from netgen import occ

    points = [occ.Pnt(*in_space(point)) for point in in_unit(facets.points, unit)]
    if facets.points.shape[1] == 2:
        return occ.Face(_wire([points[corner] for corner in _in_turn(facets.vertices)]))
    return occ.Solid(occ.Sew([occ.Face(_wire([points[corner] for corner in row])) for row in facets.vertices.tolist()]))


def _wire(corners: list[Any]) -> Any:
    from netgen import occ

    return occ.Wire([occ.Segment(start, end) for start, end in zip(corners, corners[1:] + corners[:1], strict=True)])


def _in_turn(edges: IntArray) -> list[int]:
    """The corners of a closed line in their order."""
    following, turn = dict(edges.tolist()), [int(edges[0, 0])]
    while following[turn[-1]] != turn[0]:
        turn.append(following[turn[-1]])
    return turn
