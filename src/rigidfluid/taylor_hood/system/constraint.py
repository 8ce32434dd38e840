"""The paper's constraint matrix P: every velocity on a body is its twist's, every prescribed velocity leaves the
unknowns.

All unknowns = P · (free velocities, twists of the free motions, pressures) + given values, where on all bodies that a
motion carries u = U + ω × r, r from its centre of mass, free velocities of nodes with axes of their own are along
these, and what a periodic face has is what the other one has. The coupled system is Pᵀ K P with the inertia of what the
motions carry added on the twists.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.surfaces import Surfaces, pressure_pin_vertex

# Entries of ω × r: (velocity component, component of ω, component of r, sign).
CROSS = {
    2: ((0, 0, 1, -1.0), (1, 0, 0, 1.0)),
    3: ((0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 2, 0, 1.0), (1, 0, 2, -1.0), (2, 0, 1, 1.0), (2, 1, 0, -1.0)),
}


class Constraint:
    """Which unknowns are free on one mesh topology, and the constraint matrix P for the motions' present places.

    Parameters
    ----------
    surfaces : Surfaces
        Nodes on bodies and faces.
    mesh : Mesh
        The mesh.
    prescribed : (N,) bool
        Motions whose twist is prescribed.
    """

    def __init__(self, surfaces: Surfaces, mesh: Mesh, prescribed: BoolArray) -> None:
        self.surfaces = surfaces
        self.prescribed = prescribed
        self._numbering = numbering = surfaces.numbering
        free = np.concatenate([surfaces.velocity_free.ravel(), np.ones(numbering.vertices, dtype=bool)])
        self.pressure_pin = pressure_pin_vertex(surfaces, mesh) if surfaces.enclosed else None
        images = surfaces.images[surfaces.images < numbering.vertices]
        free[surfaces.velocity_free.size + images] = False
        if self.pressure_pin is not None:
            free[surfaces.velocity_free.size + self.pressure_pin] = False
        self.free_unknowns = np.flatnonzero(free)
        self._build_pattern()

    def _build_pattern(self) -> None:
        """Lay out P once, with the free velocities first, the twists next and the pressures last."""
        d = self._numbering.dimension
        size = d + (1 if d == 2 else 3)
        free_motions = np.flatnonzero(~self.prescribed)
        is_velocity = self.free_unknowns < self._numbering.nodes * d
        velocities = int(is_velocity.sum())
        self.twist_start = velocities
        self.first_pressure = velocities + size * len(free_motions)
        self.unknowns = len(self.free_unknowns) + size * len(free_motions)
        self.free_columns = np.arange(len(self.free_unknowns)) + np.where(is_velocity, 0, size * len(free_motions))
        nodes, self._body, place = self.surfaces.carried_nodes(free_motions)
        self._slaved, first = nodes, velocities + size * place
        spread, which, self._along_axes = self.surfaces.spread(self.free_unknowns)
        rows = [spread, *(nodes * d + a for a in range(d)), *(nodes * d + a for a, *_ in CROSS[d])]
        columns = [self.free_columns[which], *(first + a for a in range(d)), *(first + d + b for _, b, *_ in CROSS[d])]
        row, column = np.concatenate(rows), np.concatenate(columns)
        shape = (self._numbering.unknowns, self.unknowns)
        numbering = sparse.coo_array((np.arange(1.0, len(row) + 1), (row, column)), shape=shape)
        self.matrix, self.transposed = numbering.tocsr(), numbering.T.tocsr()
        self._order = self.matrix.data.astype(np.int64) - 1
        self._transposed_order = self.transposed.data.astype(np.int64) - 1

    def place(self, node_points: FloatArray, position: FloatArray) -> None:
        """Fill P for nodes at ``node_points`` (nodes, d) and motions that carry each body about ``position`` (n, d)."""
        d = self._numbering.dimension
        arm = node_points[self._slaved] - position[self._body]
        flat = np.concatenate(
            [self._along_axes, np.ones(d * len(arm)), *(sign * arm[:, c] for _, _, c, sign in CROSS[d])]
        )
        self.matrix.data = flat[self._order]
        self.transposed.data = flat[self._transposed_order]
