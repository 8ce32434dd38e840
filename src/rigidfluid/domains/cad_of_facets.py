"""Polygons and polyhedra as CAD shapes, so that they can be taken out of others."""

from __future__ import annotations

from typing import Any

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.mesher_unit import in_unit
from rigidfluid.core.mesh.generation.meshing import in_space


def cad_of_facets(facets: Facets, unit: float) -> Any:
    """A ``netgen.occ`` face (2D) or solid (3D) with the corners of one closed surface, lengths over ``unit``."""
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
