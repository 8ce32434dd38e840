"""P2–P1 spaces of DOLFINx on the part of a mesh that this process holds, and how their numbers answer to ours."""

from __future__ import annotations

from functools import partial
from typing import Any

import basix.ufl
import numpy as np
from dolfinx import fem, la
from dolfinx.mesh import create_mesh
from mpi4py import MPI

from rigidfluid.backends.dolfinx import compat
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.ranks import MpiRanks
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering

# Edges of Basix' reference simplices, in the order of its P2 nodes.
_EDGES = {2: ((1, 2), (0, 2), (0, 1)), 3: ((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1))}


class Space:
    """The mesh with its spaces ``velocity`` (P2, vectors) and ``pressure`` (P1); `move` says where it is.

    With curved edges anywhere, its geometry is quadratic on all processes; ``curved`` then says which of this process'
    cells, in DOLFINx' order, have some (M,), and is None where all are straight.

    Its degrees of freedom that this process owns come first, then those of its borders that others own. Fields on
    nodes (nodes, d) and vertices (vertices,) are in the order of ``numbering``.
    """

    def __init__(self, numbering: Numbering, mesh: Mesh) -> None:
        self.numbering = numbering
        self.communicator = mesh.ranks.communicator if isinstance(mesh.ranks, MpiRanks) else MPI.COMM_SELF
        d, curved = numbering.dimension, bool(mesh.ranks.greatest(len(numbering.curved_cells)))
        self.mesh = _dolfinx_mesh(numbering, mesh, self.communicator, 2 if curved else 1)
        self.velocity = fem.functionspace(self.mesh, ("Lagrange", 2, (d,)))
        self.pressure = fem.functionspace(self.mesh, ("Lagrange", 1))
        corners = _corners(mesh, self.mesh)
        cell_nodes = np.column_stack([corners, *_middles(numbering, corners)])
        held = compat.cell_nodes(self.mesh)
        count = numbering.nodes if curved else numbering.vertices
        self._node_of_geometry = _inverse(held, cell_nodes[:, : held.shape[1]], count)
        self.curved: BoolArray | None = np.isin(cell_nodes, numbering.on_curves).max(axis=1) if curved else None
        self.node_of_dof = _inverse(self.velocity.dofmap.list, cell_nodes, numbering.nodes)
        self.vertex_of_dof = _inverse(self.pressure.dofmap.list, corners, numbering.vertices)
        self.cell_of_made = _match_cells(corners, numbering.cells)
        self._nodal = la.vector(self.velocity.dofmap.index_map, d)
        self._scalar = la.vector(self.pressure.dofmap.index_map, 1)

    @property
    def owned_nodes(self) -> IntArray:
        """Nodes that this process owns, in the order of its velocities."""
        return np.asarray(self.node_of_dof[: self.velocity.dofmap.index_map.size_local])

    @property
    def owned_vertices(self) -> IntArray:
        """Vertices that this process owns, in the order of its pressures."""
        return np.asarray(self.vertex_of_dof[: self.pressure.dofmap.index_map.size_local])

    def move(self, points: FloatArray) -> None:
        """Put the mesh where its geometry is ``points`` (vertices + K, d)."""
        at = self.numbering.node_points(points)[self._node_of_geometry]
        self.mesh.geometry.x[:, : self.numbering.dimension] = at

    def set(self, function: fem.Function, field: FloatArray) -> None:
        """Give a function of the velocity space the values of a nodal field."""
        function.x.array[:] = field[self.node_of_dof].ravel()

    def set_cells(self, function: fem.Function, values: FloatArray) -> None:
        """Give a function that is constant in each cell its ``values`` (M,), in the order of ``numbering``."""
        function.x.array[:] = values[self.cell_of_made]

    def nodal_field(self, dofs: FloatArray) -> FloatArray:
        """A nodal field (nodes, d) from its values at all local degrees of freedom."""
        field = np.empty((self.numbering.nodes, self.numbering.dimension))
        field[self.node_of_dof] = dofs.reshape(field.shape)
        return field

    def owned_sums(self, field: FloatArray) -> FloatArray:
        """Sums over the processes of a nodal field, at the owned nodes, flat."""
        self._nodal.array[:] = field[self.node_of_dof].ravel()
        self._nodal.scatter_reverse(la.InsertMode.add)
        return np.asarray(self._nodal.array[: self.owned_nodes.size * field.shape[1]].copy())

    def velocities(self, owned: FloatArray) -> FloatArray:
        """A nodal field (nodes, d) from its flat values at the owned nodes."""
        self._nodal.array[: owned.size] = owned
        self._nodal.scatter_forward()
        return self.nodal_field(self._nodal.array)

    def pressures(self, owned: FloatArray) -> FloatArray:
        """A field at the vertices (vertices,) from its values at the owned ones."""
        self._scalar.array[: owned.size] = owned
        self._scalar.scatter_forward()
        field = np.empty(self.numbering.vertices)
        field[self.vertex_of_dof] = self._scalar.array
        return field


def _dolfinx_mesh(numbering: Numbering, mesh: Mesh, communicator: Any, order: int) -> Any:
    d = numbering.dimension
    count = len(mesh.points) if mesh.part is None else int(mesh.part.counts[0])
    cells = mesh.cells if mesh.part is None else mesh.part.vertices[mesh.cells]
    if order == 2:
        number, edges = _edges_of_all(numbering, mesh)
        middles = _middles(numbering, mesh.cells)
        cells = np.column_stack([cells, *(count + number[nodes - numbering.vertices] for nodes in middles)])
        count += edges
    # Each process hands in a block of the whole's points; where they are is told by `move`.
    first, end = (count * rank // communicator.size for rank in (communicator.rank, communicator.rank + 1))
    nowhere = np.zeros((end - first, d))
    element = basix.ufl.element("Lagrange", ("triangle", "tetrahedron")[d - 2], order, shape=(d,))
    # By name: the order of `x` and `e` depends on DOLFINx' version.
    return create_mesh(communicator, cells, x=nowhere, e=element, partitioner=partial(_stay, width=d + 1))


def _middles(numbering: Numbering, corners: IntArray) -> list[IntArray]:
    """The nodes half-way along the edges of cells with these ``corners`` (M, d+1), in Basix' order."""
    return [numbering.edge_nodes(corners[:, pair]) for pair in map(list, _EDGES[numbering.dimension])]


def _edges_of_all(numbering: Numbering, mesh: Mesh) -> tuple[IntArray, int]:
    """The number of each of this process' edges among those of the whole mesh (E,), and how many there are."""
    if mesh.part is None:
        return np.arange(len(numbering.edges)), len(numbering.edges)
    pairs = np.sort(mesh.part.vertices[numbering.edges], axis=1)
    keys = pairs[:, 0] * int(mesh.part.counts[0]) + pairs[:, 1]
    whole = np.unique(np.concatenate(mesh.ranks.allgather(keys)))
    return np.searchsorted(whole, keys), len(whole)


def _stay(communicator: Any, _parts: int, _types: Any, cells: Any, width: int) -> Any:
    """A partitioner that leaves each cell with the process that has it."""
    return compat.staying(len(cells[0]) // width, communicator)


def _corners(mesh: Mesh, made: Any) -> IntArray:
    """Our numbers of the vertices of DOLFINx' cells, in its order of both (M, d+1)."""
    d = mesh.points.shape[1]
    number = made.geometry.input_global_indices[compat.cell_nodes(made)[:, : d + 1]]
    if mesh.part is None:
        return np.asarray(number, dtype=np.int64)
    order = np.argsort(mesh.part.vertices)
    return np.asarray(order[np.searchsorted(mesh.part.vertices, number, sorter=order)])


def _match_cells(theirs: IntArray, ours: IntArray) -> IntArray:
    """Our number (M,) of each of their cells, from the vertices of both (M, d+1)."""
    result = np.empty(len(ours), dtype=np.int64)
    result[_sort_rows(theirs)] = _sort_rows(ours)
    return result


def _sort_rows(cells: IntArray) -> IntArray:
    """Order (M,) of cells by their sorted vertices."""
    return np.asarray(np.lexsort(np.sort(cells, axis=1).T))


def _inverse(theirs: Any, ours: IntArray, count: int) -> IntArray:
    """Our number of each of their degrees of freedom, from both numbers cell by cell."""
    result = np.empty(count, dtype=np.int64)
    result[np.asarray(theirs).ravel()] = ours.ravel()
    return result
