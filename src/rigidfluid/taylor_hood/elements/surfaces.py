"""The nodes on bodies and on the domain's boundary, and the velocities that are prescribed there."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property

import numpy as np
import scipy
from scipy import sparse

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import cross, moment
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import SceneError
from rigidfluid.taylor_hood.elements.face import Face
from rigidfluid.taylor_hood.elements.frames import local_frames
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.periodic import originals

ROUNDING = 1e-12
"""Flow over the greatest that counts as none [1]."""

MOST_SCALED = 0.1
"""Greatest relative imbalance of inflow and outflow that a coarse mesh may make of equal ones [1]."""


_FEW = 10**6
"""Number of pairs of points up to which all are looked at: so many take as long as SciPy's trees to load."""


class Surfaces:
    """Which velocities are free on one mesh topology, and the values of the others.

    Parameters
    ----------
    numbering : Numbering
        The nodes.
    mesh : Mesh
        Its facets say which nodes lie on which surface.
    conditions : sequence of BoundaryCondition
        One per piece of the domain's boundary.
    carrier : sequence of int
        The motion that carries each body.
    """

    def __init__(
        self,
        numbering: Numbering,
        mesh: Mesh,
        conditions: Sequence[BoundaryCondition],
        carrier: Sequence[int],
    ) -> None:
        self.numbering = numbering
        self.ranks = mesh.ranks
        d = numbering.dimension
        bodies = len(carrier)
        on = [mesh.facets[mesh.markers == surface] for surface in range(bodies + len(conditions))]
        nodes = [numbering.surface_nodes(mesh, facets) for facets in on]
        self.body_nodes: list[IntArray] = nodes[:bodies]
        self._carrier: IntArray = np.array(carrier, dtype=np.int64)
        self.faces = [Face.from_facets(c, on[c.surface], nodes[c.surface], mesh, numbering) for c in conditions]
        self.velocity_free: BoolArray = np.ones((numbering.nodes, d), dtype=bool)
        for face in self.faces:
            self.velocity_free[face.nodes] &= _free_components(face, d)
        for body in self.body_nodes:
            self.velocity_free[body] = False
        held = np.logical_not(self.velocity_free.any(axis=1))
        self.frames = local_frames(self.faces, numbering.node_points(mesh.geometry), numbering.vertices, held)
        """Axes of nodes on oblique and curved faces; ``velocity_free`` is of components along a node's own axes
        there."""
        self.velocity_free[self.frames.nodes] = self.frames.free
        self.originals, self._periods = originals(self.faces, numbering.node_points(mesh.geometry))
        """The nodes that all nodes are images of, on periodic faces; else themselves."""
        self.images = np.flatnonzero(self.originals != np.arange(numbering.nodes))
        self.dirichlet_nodes = np.setdiff1d(
            np.flatnonzero(~self.velocity_free.any(axis=1)), np.concatenate([*self.body_nodes, np.empty(0, np.int64)])
        )
        self.velocity_free[self.images] = False
        self.enclosed = not any(condition.is_open for condition in conditions)

    def under(self, conditions: Sequence[BoundaryCondition]) -> Surfaces:
        """The same surfaces under ``conditions`` of the same kinds with other values."""
        other = copy(self)
        other.__dict__.pop("first_faces", None)  # those of its own conditions
        of_surface = {condition.surface: condition for condition in conditions}
        other.faces = [replace(face, condition=of_surface[face.condition.surface]) for face in self.faces]
        return other

    def prescribed_velocity(
        self, time: float, node_points: FloatArray, position: FloatArray, twist: FloatArray, prescribed: BoolArray
    ) -> FloatArray:
        """Velocity (nodes, d) with the prescribed values in place and zero elsewhere.

        ``twist`` (n, d+k) is read for the ``prescribed`` (n,) bodies alone.
        """
        velocity = np.zeros_like(node_points)
        with self.ranks.raise_on_all():
            held = [face for face in self.faces if face.condition.holds_all]
            # where several meet, walls hold the fluid, and those at rest before others
            for face in sorted(held, key=lambda face: (face.condition.is_wall, face.condition.rests)):
                velocity[face.nodes] = face.condition.velocity(time, node_points[face.nodes])
        if self.enclosed:
            self._balance(time, velocity, node_points)
        self.move_with_bodies(velocity, node_points, position, twist, prescribed)
        return velocity

    def spread(self, unknowns: IntArray) -> tuple[IntArray, IntArray, FloatArray]:
        """Entries of P in the columns of the free ``unknowns`` (u,), ascending, without bodies: along the axes of each
        node, and the same at its images.

        Returns
        -------
        rows, which, values : (e,) arrays
            The row of each entry, the place of its column in ``unknowns``, and the entry.
        """
        rows, which, values = self.frames.spread(unknowns)
        if not len(self.images):
            return rows, which, values
        d, velocities = self.velocity_free.shape[1], self.velocity_free.size
        vertices = self.images[self.images < self.numbering.vertices]
        image = np.concatenate([(self.images[:, None] * d + np.arange(d)).ravel(), velocities + vertices])
        original = self.originals[self.images][:, None] * d + np.arange(d)
        original = np.concatenate([original.ravel(), velocities + self.originals[vertices]])
        size = self.numbering.unknowns, len(rows)
        entries = sparse.csr_array((np.ones(len(rows)), (rows, np.arange(len(rows)))), shape=size)
        found = entries[original].tocoo()
        return (
            np.concatenate([rows, image[found.row]]),
            np.concatenate([which, which[found.col]]),
            np.concatenate([values, values[found.col]]),
        )

    @cached_property
    def first_faces(self) -> list[Face]:
        """The first face of each periodic pair, in the order of `pressure_drops`."""
        return [face for face in self.faces if face.condition.image is not None]

    def pressure_jump(self, time: float, points: FloatArray) -> FloatArray:
        """Excess of the pressure at vertices (vertices, d) over that at the vertex that they are images of,
        (vertices,)."""
        jump = np.zeros(len(points))
        for face, ahead in zip(self.first_faces, self._periods[: len(points)].T, strict=True):
            images = np.flatnonzero(ahead)
            drop = face.condition.pressure(time, points[self.originals[images]])
            jump[images] -= ahead[images] * drop
        return jump

    def unit_jump(self, surface: int) -> FloatArray:
        """The `pressure_jump` (vertices,) of a unit drop from the first face of a pair on, by its surface number."""
        first = [face.condition.surface for face in self.first_faces]
        return -self._periods[: self.numbering.vertices, first.index(surface)].astype(float)

    def pressure_drops(self, pressure: FloatArray) -> FloatArray:
        """Mean drops of a ``pressure`` (vertices,) from the first to the second face of each periodic pair, (k,)."""
        ahead = self._periods[: len(pressure)]
        images = np.flatnonzero(ahead.any(axis=1))
        fall = pressure[self.originals[images]] - pressure[images]
        return np.asarray(np.linalg.lstsq(ahead[images].astype(float), fall, rcond=None)[0])

    def prescribed_part(self, velocity: FloatArray) -> FloatArray:
        """The part of a ``velocity`` (nodes, d) that is not free; zero on oblique, curved and periodic faces, where
        the velocity that is held is zero, or another node's."""
        held = np.where(self.velocity_free, 0.0, velocity)
        held[self.frames.nodes] = 0.0
        held[self.images[self.velocity_free[self.originals[self.images]].any(axis=1)]] = 0.0
        return held

    def carried_nodes(self, motions: IntArray) -> tuple[IntArray, IntArray, IntArray]:
        """Nodes (c,) on the bodies that some ``motions`` (p,) carry, with the body (c,) of each, and the place (c,) of
        its motion among these."""
        place = np.full(self._carrier.max(initial=-1) + 1, -1)
        place[motions] = np.arange(len(motions))
        carried = np.flatnonzero(place[self._carrier] >= 0)
        nodes, number = joined([self.body_nodes[body] for body in carried])
        body = carried[number]
        return nodes, body, place[self._carrier[body]]

    def move_with_bodies(
        self, velocity: FloatArray, node_points: FloatArray, position: FloatArray, twist: FloatArray, chosen: BoolArray
    ) -> None:
        """Write U + ω × r over ``velocity`` (nodes, d) at the nodes of the ``chosen`` (n,) bodies."""
        nodes, body = joined(self.body_nodes)
        nodes, body = nodes[chosen[body]], body[chosen[body]]
        velocity[nodes] = rigid_velocity(twist[body], node_points[nodes] - position[body])

    def _balance(self, time: float, velocity: FloatArray, node_points: FloatArray) -> None:
        """Scale inflow and outflow of an enclosed flow to be equal on this mesh; else there is a spurious source at the
        pin.

        Quadratic elements see a prescribed flux up to their error, near the walls' corners above all.
        """
        held = [face for face in self.faces if face.condition.passes]
        if not held:
            return
        each = self.ranks.sum(np.array([face.in_and_out(node_points, velocity) for face in held]))
        flow, passed = each.sum(axis=1).sum(), np.abs(each).sum()
        if passed <= ROUNDING * self._greatest_flow(held, velocity, node_points):
            return  # it goes along its faces
        if abs(flow) > MOST_SCALED * passed:
            raise SceneError(
                "boundary",
                f"a net inflow of {flow:.6g} at time {time:g}, and {passed:.6g} in and out, without an outlet",
                f"as much outflow as inflow, but for {MOST_SCALED:g} of both by the mesh's error",
                "Balance the velocities, or give one surface type = 'pressure'.",
            )
        for face, parts in zip(held, each, strict=True):
            if parts.any():
                normal = face.condition.normal
                # through a flat face the fluid may go both ways, as it does in shear
                way = parts.sum() if normal is None else velocity[face.nodes] @ normal[:, None]
                velocity[face.nodes] *= 1.0 - np.sign(way) * flow / passed

    def _greatest_flow(self, faces: Sequence[Face], velocity: FloatArray, node_points: FloatArray) -> float:
        """Flow through a square of the domain's length at the greatest speed on ``faces`` [length^d/time]."""
        speed = max(float(np.linalg.norm(velocity[face.nodes], axis=1).max(initial=0.0)) for face in faces)
        length = float(np.ptp(node_points, axis=0).max())
        return float(self.ranks.sum(np.array([speed * length ** (node_points.shape[1] - 1)])).sum())

    def resultants(self, node_force: FloatArray, node_points: FloatArray, position: FloatArray) -> FloatArray:
        """Force and torque (n, d+k) of ``node_force`` (nodes, d) over each body's nodes.

        With several processes a node's force is the sum of what they have there.
        """
        nodes, body = joined(self.body_nodes)
        force = node_force[nodes]
        wrench = np.concatenate([force, moment(node_points[nodes] - position[body], force)], axis=1)
        shape = len(self.body_nodes), len(nodes)
        of_body = sparse.csr_array((np.ones(len(nodes)), (body, np.arange(len(nodes)))), shape=shape)
        return np.asarray(self.ranks.sum(of_body @ wrench))


def joined(each: Sequence[IntArray]) -> tuple[IntArray, IntArray]:
    """All nodes of several lists, one list after the other, (c,), and the number of each node's list, (c,)."""
    number = np.repeat(np.arange(len(each)), [len(nodes) for nodes in each])
    return np.concatenate([*each, np.empty(0, np.int64)]), number


def rigid_velocity(twist: FloatArray, arm: FloatArray) -> FloatArray:
    """U + ω × r, (N, d), for a twist (d+k,), or one for each arm (N, d+k), and arms (N, d)."""
    d = arm.shape[1]
    return np.asarray(twist[..., :d] + cross(twist[..., d:], arm))


def pressure_pin_vertex(surfaces: Surfaces, mesh: Mesh) -> int | None:
    """Pressure pin, the vertex farthest from all bodies: there an enclosed flow's pressure is zero, so that no gap
    feels it.

    Not on the boundary, if there is another: a corner's pressure may be felt by nobody. None in all processes but one.
    """
    ranks, bodies = surfaces.ranks, len(surfaces.body_nodes)
    on_bodies = np.concatenate(ranks.allgather(mesh.points[np.unique(mesh.facets[mesh.markers < bodies])]))
    origin = on_bodies if len(on_bodies) else mesh.points[:1]
    distance = _nearest_distance(mesh.points, origin)
    inside = surfaces.velocity_free[: len(mesh.points)].all(axis=1)
    preference = distance + np.where(inside, float(ranks.greatest(distance.max())), 0.0)
    local = int(np.argmax(preference))
    return local if int(np.argmax(ranks.allgather(preference[local]))) == ranks.rank else None


def _nearest_distance(points: FloatArray, others: FloatArray) -> FloatArray:
    """Distance (N,) of each point to the nearest of ``others`` (M, d) [length]."""
    if len(points) * len(others) > _FEW:
        return np.asarray(scipy.spatial.cKDTree(others).query(points)[0])
    return np.asarray(np.linalg.norm(points[:, None] - others, axis=2).min(axis=1))


def _free_components(face: Face, dimension: int) -> BoolArray:
    """Components of the velocity that are free on a whole face (d,); nodes with axes of their own have others."""
    condition = face.condition
    if face.axis is None:
        return np.full(dimension, not condition.holds_all)
    normal = np.arange(dimension) == face.axis
    return np.where(normal, not condition.prescribes_normal, not condition.prescribes_tangential)
