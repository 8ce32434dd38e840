"""A polyhedron: any shape in space with flat triangles, read from an STL file."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.bodies.facet_body import FacetBody
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.ridges import ridges_of
from rigidfluid.core.geometry.stl_file import read_stl
from rigidfluid.core.model.part import PartOptions
from rigidfluid.errors import SceneError

_THINNEST = 1e-9
"""Height of a triangle over its longest edge."""


class PolyhedronOptions(PartOptions):
    """Keys of a ``[[body]]`` table of type ``stl``: ``file`` with its triangles, and ``scale``."""

    file: str = Field(
        description="STL file, text or binary, searched for in the scene's folder; a closed surface in one piece, in "
        "any frame: the centre of mass is placed at `position`, and `orientation` rotates the body about it"
    )
    scale: float = Field(default=1.0, gt=0, description="Factor by which lengths in the file are multiplied [1]")


class Polyhedron(FacetBody):
    """The inside of a closed surface of triangles, convex or not; mass and inertia are exact.

    Parameters
    ----------
    options : PolyhedronOptions
        ``file`` and ``scale`` [1].
    dimension : int
        3.

    Raises
    ------
    SceneError
        If the dimension is 2, the file cannot be read, or its surface is open, in several pieces, of triangles with no
        area or turned against each other, crosses itself or encloses nothing.
    """

    name: ClassVar[str] = "stl"
    Options: ClassVar[type[PartOptions]] = PolyhedronOptions
    options: PolyhedronOptions

    def __init__(self, options: PolyhedronOptions, dimension: int) -> None:
        if dimension != 3:
            raise SceneError("body.type", '"stl" in 2D', "polyhedra in 3D", 'In 2D, give corners to type "polygon".')
        read = read_stl(Path(options.file), "body.file")
        facets = Facets(options.scale * read.points, read.vertices, read.markers)
        _refuse_slivers(facets.points, facets.vertices)
        _refuse_open(facets.points, facets.vertices)
        super().__init__(options, facets, "file")


def _refuse_slivers(points: FloatArray, vertices: IntArray) -> None:
    corners = points[vertices]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    twice = 2.0 * np.linalg.norm(area_vectors(points, vertices), axis=1)
    thin = np.flatnonzero(~(twice > _THINNEST * longest**2))
    if len(thin):
        found = f"{len(thin)} triangles of no area, the first at {corners[thin[0], 0].tolist()}"
        raise SceneError("body.file", found, "triangles of some area", "Take them out, and join their neighbours.")


def _refuse_open(points: FloatArray, vertices: IntArray) -> None:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    edges, triangles, turn, *_ = ridges_of(vertices)
    unlike, alone = (np.abs(turn) > 1) | (triangles > 2), triangles == 1
    if unlike.any():
        found = f"{np.count_nonzero(unlike)} edges that triangles go along in one sense"
        allowed = "triangles that all go round alike, two at each edge"
        raise SceneError("body.file", f"{found}{_first_edge(points, edges, unlike)}", allowed, "Repair the file.")
    if alone.any():
        found = f"an open surface, {np.count_nonzero(alone)} edges with one triangle{_first_edge(points, edges, alone)}"
        raise SceneError("body.file", found, "two triangles at each edge", "Close the holes, or join double points.")
    joined = coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(len(points),) * 2)
    pieces = connected_components(joined, directed=False)[0]
    if pieces > 1:
        remedy = "Write a file and a body for each; `part_of` holds bodies together."
        raise SceneError("body.file", f"a surface in {pieces} pieces", "one piece", remedy)


def _first_edge(points: FloatArray, edges: IntArray, chosen: np.ndarray) -> str:
    a, b = points[edges[np.flatnonzero(chosen)[0]]].tolist()
    return f", the first from {a} to {b}"
