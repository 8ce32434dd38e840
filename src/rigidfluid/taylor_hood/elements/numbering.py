"""The numbering of Taylor–Hood elements P2–P1 on one topology.

Nodes carry the velocity: the vertices first, then the edges' midpoints. Unknown ``node * d + component`` is a velocity,
unknown ``nodes * d + vertex`` a pressure. Nothing here depends on where the vertices are.

The same nodes say where a mesh with curved edges is (isoparametric elements): those on straight edges are half-way.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.halved_simplex import EDGES as EDGES
from rigidfluid.core.model.types import Mesh


class Numbering:
    """Nodes on ``cells`` (M, d+1) over ``vertices`` vertices: ``cell_nodes`` (M, 6 | 10), ``edges`` (E, 2).

    ``curved`` (K, 2): edges that are not straight, as pairs of vertices; ``on_curves`` (K,): the nodes on them;
    ``curved_cells`` (C,): the cells at them.
    """

    def __init__(self, cells: IntArray, vertices: int, curved: IntArray | None = None) -> None:
        self.cells = cells
        self.dimension = d = cells.shape[1] - 1
        self.vertices = vertices
        pairs = cells[:, EDGES[d]].reshape(-1, 2)
        self._edge_keys, place = np.unique(self._keys(pairs), return_inverse=True)
        self.edges: IntArray = np.stack(np.divmod(self._edge_keys, vertices), axis=1)
        self.nodes = vertices + len(self.edges)
        self.cell_nodes: IntArray = np.concatenate([cells, vertices + place.reshape(len(cells), -1)], axis=1)
        self.on_curves = np.zeros(0, dtype=np.int64) if curved is None else self.edge_nodes(curved)
        curve = np.full(len(self.edges), -1)
        curve[self.on_curves - vertices] = np.arange(len(self.on_curves))
        curve_of_edge = curve[self.cell_nodes[:, d + 1 :] - vertices]
        self.curved_cells = np.flatnonzero((curve_of_edge >= 0).any(axis=1))
        self._curve_of_edge = curve_of_edge[self.curved_cells]

    @classmethod
    def from_mesh(cls, mesh: Mesh) -> Numbering:
        """Numbering of the nodes of a mesh."""
        return cls(mesh.cells, len(mesh.points), None if mesh.curved is None else mesh.curved.vertices)

    @property
    def unknowns(self) -> int:
        """Velocity and pressure unknowns before any constraint."""
        return int(self.nodes * self.dimension + self.vertices)

    def node_points(self, points: FloatArray) -> FloatArray:
        """Coordinates of all nodes, (nodes, d), for a mesh's geometry ``points`` (vertices + K, d)."""
        found = self.interpolate_to_nodes(points[: self.vertices])
        found[self.on_curves] = points[self.vertices :]
        return found

    def geometry_of(self, field: FloatArray) -> FloatArray:
        """The part of a field on nodes (nodes, …) at those that a mesh's geometry is given by, (vertices + K, …)."""
        return np.concatenate([field[: self.vertices], field[self.on_curves]])

    def curved_cell_points(self, points: FloatArray) -> FloatArray:
        """Coordinates of the nodes of each curved cell, (C, b, d), for a geometry ``points`` (vertices + K, d)."""
        cells, d = self.cells[self.curved_cells], self.dimension
        corners = points[cells]
        middles = 0.5 * corners[:, EDGES[d]].sum(axis=2)
        bent = self._curve_of_edge >= 0
        middles[bent] = points[self.vertices + self._curve_of_edge[bent]]
        return np.concatenate([corners, middles], axis=1)

    def interpolate_to_nodes(self, field: FloatArray) -> FloatArray:
        """Values (nodes, …) of a P1 field (vertices, …) at all nodes."""
        return np.concatenate([field, 0.5 * (field[self.edges[:, 0]] + field[self.edges[:, 1]])])

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
