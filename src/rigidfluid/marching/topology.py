"""Adjacency of a mesh for marches, which stays the same while its vertices only move."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_tree import Tree
from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.adjacency import facets_beside, inner_vertices, is_whole, neighbours_of, rows_of

Numbers = NDArray[np.int32]


class Rows(NamedTuple):
    """Rows of different length: row v is ``members[start[v]:start[v + 1]]``."""

    start: Numbers
    members: Numbers


class Neighbours(NamedTuple):
    """Vertices that share a cell with each vertex, as `Rows`.

    ``elsewhere`` (n,): the square of the longest edge that a vertex has in other parts of the mesh, zero inside this
    one [length²]; empty where only edges in this part, or the whole, count.
    """

    start: Numbers
    members: Numbers
    elsewhere: FloatArray = np.empty(0)


class Adjacency(NamedTuple):
    """The ``cells`` (M, d+1), numbers of those at each vertex, and its neighbours."""

    cells: Numbers
    cell_rows: Rows
    neighbours: Neighbours


class Surfaces(NamedTuple):
    """The boundary facets of a mesh: ``facets`` (F, d), the ``marker`` (F,) of each, the facets at each vertex.

    ``across`` (F,) is the vertex of the facet's cell that is not on the facet, ``neighbours`` (F, d) the facet of the
    same surface beyond each ridge, or -1 if there is not just one.
    """

    facets: Numbers
    marker: Numbers
    across: Numbers
    neighbours: Numbers
    start: Numbers
    members: Numbers


class Target(NamedTuple):
    """Surfaces that distances are to, as they lie: vertices at ``points`` (N, d) [length], all facets of the boundary,
    whether each surface is ``wanted``, and the ``tree`` of the facets of those."""

    points: FloatArray
    surfaces: Surfaces
    wanted: BoolArray
    tree: Tree


class Seeds(NamedTuple):
    """Facets that a march starts from, whether each surface is ``wanted``, whether all are one closed piece."""

    facets: Numbers
    wanted: BoolArray
    whole: bool


class Topology:
    """Neighbours of vertices and facets, built once from cells and facets and good until those change.

    A part of a mesh that does not have all cells of its ``facets`` (F, d) gives the vertices ``across`` from them (F,).
    """

    def __init__(
        self, cells: IntArray, facets: IntArray, markers: IntArray, vertices: int, across: Numbers | None = None
    ) -> None:
        self.vertices = vertices
        self._seeds: dict[tuple[int, ...], Seeds] = {}
        own: Numbers = np.ascontiguousarray(cells, np.int32)
        cell_rows = Rows(*rows_of(own, vertices))
        self.adjacency = Adjacency(own, cell_rows, Neighbours(*neighbours_of(own, *cell_rows)))
        corners, marker = np.ascontiguousarray(facets, np.int32), markers.astype(np.int32)
        if across is None:
            across = inner_vertices(corners, own, *cell_rows)
        rows = rows_of(corners, vertices)
        self.surfaces = Surfaces(corners, marker, across, facets_beside(corners, marker, *rows), *rows)

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> Topology:
        """The topology of a mesh."""
        return cls(mesh.cells, mesh.facets, mesh.markers, len(mesh.points))

    @cached_property
    def _facets_by_surface(self) -> Rows:
        return Rows(*rows_of(self.surfaces.marker[:, None], int(self.surfaces.marker.max(initial=-1)) + 1))

    def facets_of(self, surface: int) -> Numbers:
        """Numbers of the facets of one surface; none for a surface that the mesh does not have."""
        start, members = self._facets_by_surface
        return members[start[surface] : start[surface + 1]] if 0 <= surface < len(start) - 1 else members[:0]

    def seeds(self, surfaces: Iterable[int]) -> Seeds:
        """Facets that a march from several surfaces starts from."""
        chosen = tuple(sorted(set(surfaces)))
        if chosen not in self._seeds:
            self._seeds[chosen] = self._seeds_of(chosen)
        return self._seeds[chosen]

    def _seeds_of(self, chosen: tuple[int, ...]) -> Seeds:
        wanted = np.zeros(len(self._facets_by_surface.start) - 1, dtype=bool)
        wanted[[surface for surface in chosen if 0 <= surface < len(wanted)]] = True
        facets = np.concatenate([self.facets_of(surface) for surface in chosen])
        return Seeds(facets, wanted, len(facets) == 0 or bool(is_whole(self.surfaces.neighbours, facets)))
