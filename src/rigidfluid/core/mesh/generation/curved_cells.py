"""The cells at curved edges: what bending leaves of their volume and their quality."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.generation.refine_surface import edge_numbers
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.model.types import Mesh


class CurvedCells:
    """The cells at a mesh's curved edges, and how well they stand being bent.

    ``cells`` (C, d+1); ``bent`` (C, edges of a cell): which of the mesh's curved edges each edge is, -1 where it is
    straight.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._vertices, d = len(mesh.points), mesh.points.shape[1]
        self._pairs = list(combinations(range(d + 1), 2))
        if mesh.curved is None:
            self.cells, self.bent = mesh.cells[:0], np.zeros((0, len(self._pairs)), dtype=np.int64)
            return
        edges = mesh.curved.vertices
        order = np.lexsort(edges.T[::-1])
        found = np.stack([edge_numbers(mesh.cells, pair, edges[order], self._vertices) for pair in self._pairs], axis=1)
        at_curves = (found >= 0).any(axis=1)
        self.cells = mesh.cells[at_curves]
        self.bent = np.where(found >= 0, order[found], -1)[at_curves]

    def least_jacobian(self, geometry: FloatArray) -> FloatArray:
        """Least det ∂x/∂X of each cell's quadratic map over that of its straight one, at its nodes (C,), for a geometry
        (N + K, d) [length].

        x = Σ λᵢ xᵢ + Σ 4 λₐ λ_b δₐ_b with the shift δ of each edge's middle, so that ∂x/∂X = E + Σ 4 δ (λₐ ∇λ_b + λ_b
        ∇λₐ)ᵀ. Exact for one bent edge, whose determinant is linear.
        """
        corners = geometry[self.cells]
        edges = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        slopes = np.vstack([-np.ones(edges.shape[1]), np.eye(edges.shape[1])])  # ∇λ
        at = np.vstack([np.eye(len(slopes)), [(np.eye(len(slopes))[[a, b]]).mean(axis=0) for a, b in self._pairs]])
        jacobian = np.repeat(edges[:, None], len(at), axis=1)
        for column, (a, b) in enumerate(self._pairs):
            shift = geometry[self._vertices + self.bent[:, column]] - 0.5 * (corners[:, a] + corners[:, b])
            shift[self.bent[:, column] < 0] = 0.0
            slope = at[:, a, None] * slopes[b] + at[:, b, None] * slopes[a]
            jacobian += 4.0 * shift[:, None, :, None] * slope[None, :, None, :]
        return np.asarray((np.linalg.det(jacobian) / np.linalg.det(edges)[:, None]).min(axis=1))

    def quality(self, geometry: FloatArray) -> FloatArray:
        """Quality of the straight cells times their `least_jacobian`, zero where that is negative, (C,) [1]."""
        return cell_quality(geometry[: self._vertices], self.cells) * np.maximum(self.least_jacobian(geometry), 0.0)
