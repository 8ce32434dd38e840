"""The constraint matrix P of `rigidfluid.taylor_hood.system.constraint`, distributed.

Columns of each process are its own free velocities first, next all twists on the root, and then its free pressures.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from petsc4py import PETSc
from scipy import sparse

from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.constraint import CROSS


class DistributedConstraint:
    """Free unknowns on one topology, and P as a PETSc matrix; motions that are ``prescribed`` (N,) have no unknowns.

    ``pressure_pin``: a vertex of this process whose pressure is zero, None elsewhere. ``velocity_free`` says which of
    the process' own velocities are free.
    """

    def __init__(self, space: Space, surfaces: Surfaces, prescribed: BoolArray, pressure_pin: int | None) -> None:
        self.space, ranks = space, surfaces.ranks
        d = space.numbering.dimension
        self._free_motions = np.flatnonzero(~prescribed)
        self.velocity_free = surfaces.velocity_free[space.owned_nodes].ravel()
        self._pressure_free = space.owned_vertices != (-1 if pressure_pin is None else pressure_pin)
        self.velocities, self.pressures = int(self.velocity_free.sum()), int(self._pressure_free.sum())
        width = d + (1 if d == 2 else 3)
        self.twists = width * len(self._free_motions) if ranks.is_root else 0
        self.columns = self.velocities + self.twists + self.pressures
        counts = ranks.allgather((self.columns, self.velocities))
        self.first_column = sum(columns for columns, _ in counts[: ranks.rank])
        self.unknowns = sum(columns for columns, _ in counts)
        self._first_twist = counts[0][1]
        place = np.full(space.numbering.nodes, -1)
        place[space.owned_nodes] = np.arange(len(space.owned_nodes))
        nodes, body, carrier = surfaces.carried_nodes(self._free_motions)
        owned = place[nodes] >= 0
        self._slaved, self._body, self._carrier = place[nodes[owned]], body[owned], carrier[owned]
        self._width = width
        self._matrix: Any = None
        self._lay_out()

    @property
    def rows(self) -> int:
        """Velocities and pressures that this process owns."""
        return len(self.velocity_free) + len(self._pressure_free)

    @property
    def twist_slice(self) -> slice:
        """The twists among this process' columns; empty but on the root."""
        return slice(self.velocities, self.velocities + self.twists)

    @property
    def is_coarse(self) -> BoolArray:
        """Tell whether linear functions have this process' free velocities and twists: at vertices, and all twists."""
        at_vertices = np.repeat(self.space.owned_nodes < self.space.numbering.vertices, self.space.numbering.dimension)
        return np.concatenate([at_vertices[self.velocity_free], np.ones(self.twists, dtype=bool)])

    def matrix(self, node_points: FloatArray, position: FloatArray) -> Any:
        """P for nodes at ``node_points`` (nodes, d) and motions that carry each body about ``position`` (n, d).

        One matrix is filled again and again, as products with it are told from others by it.
        """
        d = self.space.numbering.dimension
        arm = node_points[self.space.owned_nodes[self._slaved]] - position[self._body]
        ones = np.ones(len(self._order) - len(CROSS[d]) * len(arm))
        data = np.concatenate([ones, *(sign * arm[:, c] for _, _, c, sign in CROSS[d])])[self._order]
        if self._matrix is None:
            sizes = (self.rows, None), (self.columns, None)
            self._matrix = PETSc.Mat().createAIJ(sizes, csr=(*self._pattern, data), comm=self.space.communicator)
        else:
            self._matrix.setValuesCSR(*self._pattern, data)
        self._matrix.assemble()
        return self._matrix

    def reduced(self, velocity: FloatArray, twist: FloatArray, pressure: FloatArray) -> FloatArray:
        """This process' unknowns from fields on nodes and vertices and all motions' twists (N, d+k)."""
        space = self.space
        on_owned = velocity[space.owned_nodes].ravel()[self.velocity_free]
        twists = twist[self._free_motions].ravel() if self.twists else np.zeros(0)
        return np.concatenate([on_owned, twists, pressure[space.owned_vertices][self._pressure_free]])

    def _free_columns(self) -> tuple[IntArray, IntArray]:
        free = np.flatnonzero(np.concatenate([self.velocity_free, self._pressure_free]))
        number = np.arange(len(free)) + np.where(np.arange(len(free)) < self.velocities, 0, self.twists)
        return free, self.first_column + number

    def _lay_out(self) -> None:
        """Lay out the rows of P, and the order of its values: ones of free unknowns, U and ω × r of u = U + ω × r."""
        d, at, first = self.space.numbering.dimension, self._slaved, self._first_twist + self._width * self._carrier
        free, number = self._free_columns()
        row = np.concatenate([free, *(at * d + a for a in range(d)), *(at * d + a for a, *_ in CROSS[d])])
        column = np.concatenate([number, *(first + a for a in range(d)), *(first + d + b for _, b, *_ in CROSS[d])])
        entries = np.arange(len(row)) + 1.0
        matrix = sparse.coo_array((entries, (row, column)), shape=(self.rows, self.unknowns)).tocsr()
        matrix.sort_indices()
        self._pattern = matrix.indptr.astype(PETSc.IntType), matrix.indices.astype(PETSc.IntType)
        self._order = matrix.data.astype(np.int64) - 1
