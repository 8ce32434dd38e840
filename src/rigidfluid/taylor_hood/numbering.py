"""The numbering of Taylor–Hood elements P2–P1 on one topology.

Nodes carry the velocity: the vertices first, then the edges' midpoints. Unknown ``node * d + component`` is a velocity,
unknown ``nodes * d + vertex`` a pressure. Nothing here depends on where the vertices are.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.model.types import FloatArray, IntArray, Mesh

# Edges of a simplex as pairs of its vertices, in the order of the nodes of VTK's quadratic cells.
EDGES = {2: ((0, 1), (1, 2), (0, 2)), 3: ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))}


class Numbering:
    """Nodes on ``cells`` (M, d+1) over ``vertices`` vertices: ``cell_nodes`` (M, 6 | 10), ``edges`` (E, 2)."""

    def __init__(self, cells: IntArray, vertices: int) -> None:
        self.cells = cells
        self.dimension = d = cells.shape[1] - 1
        self.vertices = vertices
        pairs = cells[:, EDGES[d]].reshape(-1, 2)
        self._edge_keys, place = np.unique(self._keys(pairs), return_inverse=True)
        self.edges: IntArray = np.stack(np.divmod(self._edge_keys, vertices), axis=1)
        self.nodes = vertices + len(self.edges)
        self.cell_nodes: IntArray = np.concatenate([cells, vertices + place.reshape(len(cells), -1)], axis=1)

    @property
    def unknowns(self) -> int:
        """Velocity and pressure unknowns before any constraint."""
        return int(self.nodes * self.dimension + self.vertices)

    def node_points(self, points: FloatArray) -> FloatArray:
        """Coordinates of all nodes, (nodes, d), for vertices at ``points`` (vertices, d); also extends any P1 field."""
        return np.concatenate([points, 0.5 * (points[self.edges[:, 0]] + points[self.edges[:, 1]])])

    def facet_nodes(self, facets: IntArray) -> IntArray:
        """Nodes of boundary ``facets`` (F, d): their vertices, then their edges' midpoints; (F, 3 | 6)."""
        return np.column_stack([facets, *(self.edge_nodes(facets[:, pair]) for pair in facet_edges(self.dimension))])

    def edge_nodes(self, pairs: IntArray) -> IntArray:
        """Nodes at the midpoints of edges, given as pairs of vertices (E, 2)."""
        return np.asarray(self.vertices + np.searchsorted(self._edge_keys, self._keys(pairs)))

    def surface_nodes(self, mesh: Mesh, facets: IntArray) -> IntArray:
        """Nodes on the ``facets`` (F, d) of one surface, also where those are in other processes' parts."""
        if mesh.part is None:
            return np.unique(self.facet_nodes(facets))
        number = mesh.part.vertices
        whole = np.concatenate(mesh.ranks.allgather(number[facets]))
        edges = np.concatenate([whole[:, pair] for pair in facet_edges(self.dimension)])
        count = int(mesh.part.counts[0])
        on_edge = np.isin(_keys(number[self.edges], count), _keys(edges, count))
        return np.concatenate([np.flatnonzero(np.isin(number, whole)), self.vertices + np.flatnonzero(on_edge)])

    def _keys(self, pairs: IntArray) -> IntArray:
        return _keys(pairs, self.vertices)


def facet_edges(dimension: int) -> list[list[int]]:
    """Edges of a facet as pairs of its vertices."""
    return [[0, 1]] if dimension == 2 else [[0, 1], [1, 2], [0, 2]]


def _keys(pairs: IntArray, vertices: int) -> IntArray:
    """One number for each pair, whatever its order."""
    return np.asarray(pairs.min(axis=1) * vertices + pairs.max(axis=1))
