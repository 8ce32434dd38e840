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
from rigidfluid.core.model.ranks import MpiRanks
from rigidfluid.core.model.types import FloatArray, IntArray, Mesh
from rigidfluid.taylor_hood.numbering import Numbering

# Edges of Basix' reference simplices, in the order of its P2 nodes.
_EDGES = {2: ((1, 2), (0, 2), (0, 1)), 3: ((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1))}


class Space:
    """The mesh with its spaces ``velocity`` (P2, vectors) and ``pressure`` (P1); `move` says where its vertices are.

    Its degrees of freedom that this process owns come first, then those of its borders that others own. Fields on
    nodes (nodes, d) and vertices (vertices,) are in the order of ``numbering``.
    """

    def __init__(self, numbering: Numbering, mesh: Mesh) -> None:
        self.numbering = numbering
        self.communicator = mesh.ranks.communicator if isinstance(mesh.ranks, MpiRanks) else MPI.COMM_SELF
        self.mesh = _as_dolfinx(mesh, self.communicator)
        d = numbering.dimension
        self.velocity = fem.functionspace(self.mesh, ("Lagrange", 2, (d,)))
        self.pressure = fem.functionspace(self.mesh, ("Lagrange", 1))
        corners = _corners(mesh, self.mesh)
        self._vertex_of_geometry = _inverse(compat.cell_vertices(self.mesh), corners, numbering.vertices)
        middles = [numbering.edge_nodes(corners[:, pair]) for pair in map(list, _EDGES[d])]
        self.node_of_dof = _inverse(self.velocity.dofmap.list, np.column_stack([corners, *middles]), numbering.nodes)
        self.vertex_of_dof = _inverse(self.pressure.dofmap.list, corners, numbering.vertices)
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
        """Put the vertices at ``points`` (vertices, d)."""
        self.mesh.geometry.x[:, : self.numbering.dimension] = points[self._vertex_of_geometry]

    def set(self, function: fem.Function, field: FloatArray) -> None:
        """Give a function of the velocity space the values of a nodal field."""
        function.x.array[:] = field[self.node_of_dof].ravel()

    def as_nodal(self, dofs: FloatArray) -> FloatArray:
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
        return self.as_nodal(self._nodal.array)

    def pressures(self, owned: FloatArray) -> FloatArray:
        """A field at the vertices (vertices,) from its values at the owned ones."""
        self._scalar.array[: owned.size] = owned
        self._scalar.scatter_forward()
        field = np.empty(self.numbering.vertices)
        field[self.vertex_of_dof] = self._scalar.array
        return field


def _as_dolfinx(mesh: Mesh, communicator: Any) -> Any:
    d = mesh.points.shape[1]
    cells, count = mesh.cells, len(mesh.points)
    if mesh.part is not None:
        cells, count = mesh.part.vertices[cells], int(mesh.part.counts[0])
    # Each process hands in a block of the whole's points; where they are is told by `move`.
    first, end = (count * rank // communicator.size for rank in (communicator.rank, communicator.rank + 1))
    nowhere = np.zeros((end - first, d))
    element = basix.ufl.element("Lagrange", ("triangle", "tetrahedron")[d - 2], 1, shape=(d,))
    # By name: the order of `x` and `e` depends on DOLFINx' version.
    return create_mesh(communicator, cells, x=nowhere, e=element, partitioner=partial(_stay, width=d + 1))


def _stay(communicator: Any, _parts: int, _types: Any, cells: Any, width: int) -> Any:
    """A partitioner that leaves each cell with the process that has it."""
    return compat.staying(len(cells[0]) // width, communicator)


def _corners(mesh: Mesh, made: Any) -> IntArray:
    """Our numbers of the vertices of DOLFINx' cells, in its order of both (M, d+1)."""
    number = made.geometry.input_global_indices[compat.cell_vertices(made)]
    if mesh.part is None:
        return np.asarray(number, dtype=np.int64)
    order = np.argsort(mesh.part.vertices)
    return np.asarray(order[np.searchsorted(mesh.part.vertices, number, sorter=order)])


def _inverse(theirs: Any, ours: IntArray, count: int) -> IntArray:
    """Our number of each of their degrees of freedom, from both numbers cell by cell."""
    result = np.empty(count, dtype=np.int64)
    result[np.asarray(theirs).ravel()] = ours.ravel()
    return result
