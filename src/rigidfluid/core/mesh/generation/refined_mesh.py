"""A mesh of halved edges: each triangle becomes four, each tetrahedron eight."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core.geometry.arrays import IntArray
from rigidfluid.core.geometry.halved_simplex import CHILDREN, EDGES
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_edges import with_curved_edges
from rigidfluid.core.mesh.generation.refine_surface import middles_on_surfaces
from rigidfluid.core.mesh.topology import orient
from rigidfluid.core.model.types import Mesh


def refined_mesh(mesh: Mesh, fluid_domain: FluidDomain) -> Mesh:
    """The whole ``mesh`` with all edges halved, the new vertices after its own, in the order of their edges' vertices.

    On bodies and curved walls the new vertices are on the exact surface, and the middles of new edges if the mesh
    itself is curved there.
    """
    count, d = len(mesh.points), mesh.points.shape[1]
    pairs = np.sort(mesh.cells[:, EDGES[d]].reshape(-1, 2), axis=1)
    keys = np.unique(pairs[:, 0] * count + pairs[:, 1])
    edges = np.stack(np.divmod(keys, count), axis=1)
    middles = mesh.points[edges].mean(axis=1) if mesh.curved else middles_on_surfaces(mesh, edges, fluid_domain)
    if mesh.curved is not None:
        middles[np.searchsorted(keys, _keys(mesh.curved.vertices, count))] = mesh.curved.middles

    def children(simplices: IntArray) -> IntArray:
        axes = simplices.shape[1] - 1
        halves = [count + np.searchsorted(keys, _keys(simplices[:, pair], count)) for pair in EDGES[axes]]
        nodes = np.column_stack([simplices, *halves])
        return nodes[:, CHILDREN[axes]].reshape(-1, axes + 1)

    points, cells = np.concatenate([mesh.points, middles]), children(mesh.cells)
    markers = np.repeat(mesh.markers, len(CHILDREN[d - 1]))
    fine = replace(orient(Mesh(points, cells, children(mesh.facets), markers)), periods=mesh.periods)
    return fine if mesh.curved is None else with_curved_edges(fine, fluid_domain)


def _keys(pairs: IntArray, count: int) -> IntArray:
    return np.asarray(pairs.min(axis=1) * count + pairs.max(axis=1))
