"""What a march needs to know of a mesh and what stays the same while its vertices only move."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.types import BoolArray, IntArray, Mesh
from rigidfluid.marching.adjacency import inner_vertices, neighbours_of, rows_of

Numbers = NDArray[np.int32]


class Rows(NamedTuple):
    """Rows of different length: row v is ``members[start[v]:start[v + 1]]``."""

    start: Numbers
    members: Numbers


class Surfaces(NamedTuple):
    """The boundary facets of a mesh: ``facets`` (F, d), the ``marker`` (F,) of each, the facets at each vertex.

    ``across`` (F,) is the vertex of the facet's cell that is not on the facet.
    """

    facets: Numbers
    marker: Numbers
    across: Numbers
    start: Numbers
    members: Numbers


class Topology:
    """Neighbours of vertices and facets, built once from cells and facets and good until those change.

    Parameters
    ----------
    cells : (M, d+1) array
        Vertex numbers of each simplex.
    facets : (F, d) array
        Vertex numbers of each boundary facet.
    markers : (F,) array
        The surface that each facet lies on.
    vertices : int
        How many vertices there are.
    """

    def __init__(self, cells: IntArray, facets: IntArray, markers: IntArray, vertices: int) -> None:
        self.vertices = vertices
        self.cells: Numbers = np.ascontiguousarray(cells, np.int32)
        self.cell_rows = Rows(*rows_of(self.cells, vertices))
        self.neighbours = Rows(*neighbours_of(self.cells, *self.cell_rows))
        corners = np.ascontiguousarray(facets, np.int32)
        across = inner_vertices(corners, self.cells, *self.cell_rows)
        self.surfaces = Surfaces(corners, markers.astype(np.int32), across, *rows_of(corners, vertices))

    @classmethod
    def of(cls, mesh: Mesh) -> Topology:
        """The topology of a mesh."""
        return cls(mesh.cells, mesh.facets, mesh.markers, len(mesh.points))

    @cached_property
    def _facets_by_surface(self) -> Rows:
        return Rows(*rows_of(self.surfaces.marker[:, None], int(self.surfaces.marker.max(initial=-1)) + 1))

    def facets_of(self, surface: int) -> Numbers:
        """Numbers of the facets of one surface; none for a surface that the mesh does not have."""
        start, members = self._facets_by_surface
        return members[start[surface] : start[surface + 1]] if 0 <= surface < len(start) - 1 else members[:0]

    def seeds(self, surfaces: Iterable[int]) -> tuple[Numbers, BoolArray]:
        """Facets of several surfaces, and for each surface number whether it is among them."""
        chosen = sorted(set(surfaces))
        wanted = np.zeros(len(self._facets_by_surface.start) - 1, dtype=bool)
        wanted[[surface for surface in chosen if 0 <= surface < len(wanted)]] = True
        return np.concatenate([self.facets_of(surface) for surface in chosen]), wanted
