"""A piece of the domain's boundary on one topology."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.facet_integrals import (
    area_at_points,
    area_vectors,
    facet_weights,
    into_fluid,
    normals_at_nodes,
)
from rigidfluid.taylor_hood.elements.numbering import Numbering


@dataclass(frozen=True)
class Face:
    """Piece with one ``condition``: ``facets`` (F, d) with their ``facet_nodes`` (F, 3 | 6), and all ``nodes`` on it,
    also those of facets that other processes hold."""

    condition: BoundaryCondition
    facets: IntArray
    facet_nodes: IntArray
    nodes: IntArray

    @classmethod
    def from_facets(
        cls, condition: BoundaryCondition, facets: IntArray, nodes: IntArray, mesh: Mesh, numbering: Numbering
    ) -> Face:
        """Face of these ``facets``; unless it is flat or a wall they are turned so that their normals point into the
        fluid."""
        if (condition.normal is None or condition.is_seam) and not condition.is_wall:
            facets = into_fluid(facets, mesh.cells, mesh.points)
        return cls(condition, facets, numbering.facet_nodes(facets), nodes)

    @property
    def _normal(self) -> FloatArray | None:
        """The normal of all facets, None where each has its own."""
        return None if self.condition.is_seam else self.condition.normal

    @cached_property
    def axis(self) -> int | None:
        """The axis that the face lies across, if it is flat and there is one."""
        normal = self.condition.normal
        return None if normal is None else Plane(np.zeros_like(normal), normal).axis

    def area_vectors(self, node_points: FloatArray) -> FloatArray:
        """∫ φᵢ n over each facet for its nodes i, n into the fluid, (F, 3 | 6, d) [length^(d-1)].

        ``node_points`` (nodes, d) [length].
        """
        if self._normal is None:
            return area_vectors(node_points[self.facet_nodes])
        return np.asarray(facet_weights(node_points, self.facets)[..., None] * self._normal)

    def pressure_load(self, time: float, node_points: FloatArray) -> FloatArray:
        """∫ φᵢ p n of the given pressure over each facet for its nodes i, (F, 3 | 6, d) [force], n into the fluid.

        ``node_points`` (nodes, d) [length].
        """
        pressure = self.condition.pressure(time, node_points[self.facet_nodes.ravel()])
        return np.asarray(pressure.reshape(self.facet_nodes.shape)[..., None] * self.area_vectors(node_points))

    def normals(self, node_points: FloatArray) -> FloatArray:
        """Unit normals into the fluid of each facet at its nodes, (F, 3 | 6, d), for ``node_points`` (nodes, d)."""
        if self._normal is None:
            return normals_at_nodes(node_points[self.facet_nodes])
        return np.broadcast_to(self._normal, (*self.facet_nodes.shape, len(self._normal)))

    def inflow(self, node_points: FloatArray, velocity: FloatArray) -> FloatArray:
        """The part of ∫ u·n of each facet's nodes, (F, 3 | 6) [length^d/time], n into the fluid.

        ``node_points``, ``velocity`` (nodes, d) [length, length/time].
        """
        return np.asarray(np.einsum("fid,fid->fi", self.area_vectors(node_points), velocity[self.facet_nodes]))

    def energy_inflow(self, node_points: FloatArray, velocity: FloatArray, carrier: FloatArray) -> float:
        """∫ ½|u|² c·n, exactly what convection by c carries in through a flat face [length^(d+2)/time³].

        ``node_points``, ``velocity`` u and ``carrier`` c (nodes, d) [length, length/time].
        """
        shapes, inflow = self.inflow_at_points(node_points, carrier)
        u = shapes @ velocity[self.facet_nodes]
        return 0.5 * float(np.sum(np.sum(u * u, axis=2) * inflow))

    def inflow_at_points(self, node_points: FloatArray, carrier: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gauss' rule on each facet: the nodes' functions at its points, (q, 3 | 6), and c·n dA there, (F, q), n into
        the fluid.

        ``node_points``, ``carrier`` c (nodes, d) [length, length/time].
        """
        shapes, area = area_at_points(node_points[self.facet_nodes])
        if self._normal is not None:
            area = np.linalg.norm(area, axis=2, keepdims=True) * self._normal
        return shapes, np.asarray(np.sum((shapes @ carrier[self.facet_nodes]) * area, axis=2))

    def in_and_out(self, node_points: FloatArray, velocity: FloatArray) -> FloatArray:
        """Inflow and outflow (negative), (2,) [length^d/time]; the sum of both, and 0, of a curved face.

        ``node_points``, ``velocity`` (nodes, d) [length, length/time].
        """
        inflow = self.inflow(node_points, velocity)
        if self._normal is None:
            return np.array([inflow.sum(), 0.0])
        return np.array([np.maximum(inflow, 0.0).sum(), np.minimum(inflow, 0.0).sum()])
