"""The paper's operator P: every velocity on a body is its twist's, every prescribed velocity leaves the unknowns.

All unknowns = P · (free velocities, twists of the free bodies, pressures) + given values, where on a body
u = U + ω × r. The coupled system is Pᵀ K P with the bodies' own inertia added on the twists.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from rigidfluid.backends.scikit_fem.facets import facet_weights
from rigidfluid.backends.scikit_fem.space import TaylorHood
from rigidfluid.core.rigid import cross, moment
from rigidfluid.core.types import BoolArray, BoundaryCondition, FloatArray, IntArray, Mesh

# Entries of ω × r: (velocity component, component of ω, component of r, sign).
_CROSS = {
    2: ((0, 0, 1, -1.0), (1, 0, 0, 1.0)),
    3: ((0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 2, 0, 1.0), (1, 0, 2, -1.0), (2, 0, 1, 1.0), (2, 1, 0, -1.0)),
}


@dataclass(frozen=True)
class Face:
    """A face of the domain on one topology: its ``condition``, ``facets`` (F, d) and their ``nodes`` (F, 3 | 6)."""

    condition: BoundaryCondition
    facets: IntArray
    nodes: IntArray


class Constraint:
    """Which unknowns are free on one mesh topology, and the operator P for the bodies' present places.

    Parameters
    ----------
    space : TaylorHood
        Numbering of the unknowns.
    mesh : Mesh
        Its facets say which nodes lie on which surface.
    conditions : sequence of BoundaryCondition
        One per face of the domain.
    controlled : (n,) bool
        Bodies whose twist is given.
    """

    def __init__(
        self, space: TaylorHood, mesh: Mesh, conditions: Sequence[BoundaryCondition], controlled: BoolArray
    ) -> None:
        self.space = space
        self.controlled = controlled
        d, bodies = space.dimension, len(controlled)
        facet_nodes = space.facet_nodes(mesh.facets)
        on = [mesh.markers == surface for surface in range(bodies + len(conditions))]
        self.body_nodes: list[IntArray] = [np.unique(facet_nodes[on[body]]) for body in range(bodies)]
        self.faces = [Face(c, mesh.facets[on[c.surface]], facet_nodes[on[c.surface]]) for c in conditions]
        free = np.ones(space.unknowns, dtype=bool)
        velocity_free = free[: space.nodes * d].reshape(-1, d)
        for face in self.faces:
            velocity_free[face.nodes] &= _free_components(face.condition, d)
        for nodes in self.body_nodes:
            velocity_free[nodes] = False
        self.dirichlet_nodes = np.setdiff1d(
            np.flatnonzero(~velocity_free.any(axis=1)), np.concatenate([*self.body_nodes, np.empty(0, np.int64)])
        )
        open_to_pressure = any(condition.type == "pressure" for condition in conditions)
        self.pinned = None if open_to_pressure else _far_vertex(mesh, bodies)
        if self.pinned is not None:
            free[space.nodes * d + self.pinned] = False
        self.free_unknowns = np.flatnonzero(free)
        self._build_pattern()

    def _build_pattern(self) -> None:
        """Lay out P once, with the free velocities first, the twists next and the pressures last."""
        d = self.space.dimension
        size = d + (1 if d == 2 else 3)
        free_bodies = np.flatnonzero(~self.controlled)
        is_velocity = self.free_unknowns < self.space.nodes * d
        velocities = int(is_velocity.sum())
        self.twist_start = velocities
        self.unknowns = len(self.free_unknowns) + size * len(free_bodies)
        self.free_columns = np.arange(len(self.free_unknowns)) + np.where(is_velocity, 0, size * len(free_bodies))
        rows, columns = [self.free_unknowns], [self.free_columns]
        for place, body in enumerate(free_bodies):
            nodes, start = self.body_nodes[body], velocities + size * place
            rows += [nodes * d + a for a in range(d)] + [nodes * d + a for a, *_ in _CROSS[d]]
            columns += [np.full(len(nodes), start + a) for a in range(d)]
            columns += [np.full(len(nodes), start + d + b) for _, b, *_ in _CROSS[d]]
        row, column = np.concatenate(rows), np.concatenate(columns)
        shape = (self.space.unknowns, self.unknowns)
        numbering = sparse.coo_array((np.arange(1.0, len(row) + 1), (row, column)), shape=shape)
        self.operator, self.transposed = numbering.tocsr(), numbering.T.tocsr()
        self._order = self.operator.data.astype(np.int64) - 1
        self._transposed_order = self.transposed.data.astype(np.int64) - 1

    def place(self, node_points: FloatArray, position: FloatArray) -> None:
        """Fill P for nodes at ``node_points`` (nodes, d) and bodies centred at ``position`` (n, d)."""
        d = self.space.dimension
        values = [np.ones(len(self.free_unknowns))]
        for body in np.flatnonzero(~self.controlled):
            arm = node_points[self.body_nodes[body]] - position[body]
            values += [np.ones(len(arm) * d), *(sign * arm[:, c] for _, _, c, sign in _CROSS[d])]
        flat = np.concatenate(values)
        self.operator.data = flat[self._order]
        self.transposed.data = flat[self._transposed_order]

    def given(self, time: float, node_points: FloatArray, position: FloatArray, twist: FloatArray) -> FloatArray:
        """All unknowns (nodes·d + vertices,) with the prescribed velocities in place and zero elsewhere.

        ``twist`` (n, d+k) is read for the controlled bodies alone.
        """
        d = self.space.dimension
        values = np.zeros(self.space.unknowns)
        velocity = values[: self.space.nodes * d].reshape(-1, d)
        for face in self.faces:
            if face.condition.type == "velocity" and face.condition.value is not None:
                nodes = np.unique(face.nodes)
                velocity[nodes] = face.condition.value(time, node_points[nodes])
        for face in self.faces:
            if face.condition.type == "wall":
                velocity[face.nodes] = 0.0
        if self.pinned is not None:
            self._balance(velocity, node_points)
        for body in np.flatnonzero(self.controlled):
            nodes = self.body_nodes[body]
            velocity[nodes] = rigid_velocity(twist[body], node_points[nodes] - position[body])
        return values

    def _balance(self, velocity: FloatArray, node_points: FloatArray) -> None:
        """Scale inflow and outflow of an enclosed flow to be equal on this mesh; else the pinned vertex leaks.

        Quadratic elements see a prescribed flux up to their error, near the walls' corners above all.
        """
        held = [face for face in self.faces if face.condition.type == "velocity"]
        flow = np.array(
            [
                np.sum(facet_weights(node_points, face.facets) * (velocity[face.nodes] @ face.condition.normal))
                for face in held
            ]
        )
        passed = np.abs(flow).sum()
        for face, part in zip(held, flow, strict=True):
            if part != 0.0:
                velocity[np.unique(face.nodes)] *= 1.0 - np.sign(part) * flow.sum() / passed

    def resultant(self, body: int, node_force: FloatArray, node_points: FloatArray, position: FloatArray) -> FloatArray:
        """Force and torque (d+k,) of ``node_force`` (nodes, d) over one body's nodes: the body's rows of Pᵀ."""
        nodes = self.body_nodes[body]
        arm, force = node_points[nodes] - position[body], node_force[nodes]
        return np.concatenate([force.sum(axis=0), moment(arm, force).sum(axis=0)])


def rigid_velocity(twist: FloatArray, arm: FloatArray) -> FloatArray:
    """U + ω × r, (N, d), for a twist (d+k,) and arms (N, d)."""
    d = arm.shape[1]
    return np.asarray(twist[:d] + cross(twist[d:], arm))


def _free_components(condition: BoundaryCondition, dimension: int) -> BoolArray:
    across = np.abs(condition.normal) > 0.5
    if condition.type == "slip":
        return ~across
    return across if condition.type == "pressure" else np.zeros(dimension, dtype=bool)


def _far_vertex(mesh: Mesh, bodies: int) -> int:
    """The vertex farthest from all bodies: where an enclosed flow's pressure is pinned, so that no gap feels it."""
    on_bodies = np.unique(mesh.facets[mesh.markers < bodies])
    if len(on_bodies) == 0:
        return 0
    distance, _ = cKDTree(mesh.points[on_bodies]).query(mesh.points)
    return int(np.argmax(distance))
