"""Bends the edges on bodies and curved walls onto the exact surface, so that cells there are quadratic (isoparametric).

A straight facet cuts off L²/(8R) of a surface of radius R, and drag, lift and volume are as wrong as that; through the
surface's point at its middle it follows the surface to order 4 in L.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, IntArray
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_cells import CurvedCells
from rigidfluid.core.mesh.generation.periodic import on_periodic_surfaces
from rigidfluid.core.mesh.generation.refine_surface import edge_numbers, edges_of_facets, on_kept_surfaces
from rigidfluid.core.mesh.generation.smooth_fluid import smooth_fluid
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.model.types import CurvedEdges, Mesh

SQUEEZED = 0.3
"""An edge stays straight where bending it would leave less than this of a cell's volume anywhere in the cell."""

DOUBTFUL = 0.5 * (1.0 + SQUEEZED)
"""The same for a cell in a gap, whose share of its volume falls to `SQUEEZED` when the gap has halved, before which no
other mesh is made; and for a cell whose quality it leaves below `LEAST_QUALITY`."""

LEAST_QUALITY = 0.2
"""A mesh is regenerated at half of the quality that it had, and no cell is to be worse than 0.1."""

NARROW = 1.5
"""A cell is in a gap that is at most this many times wider than the cell's longest edge."""

FLAT = 1e-9
"""An edge is straight when the surface is nearer to its middle than this many of its lengths."""


def with_curved_edges(mesh: Mesh, fluid_domain: FluidDomain) -> Mesh:
    """Bend the edges on bodies and curved walls of a whole, straight mesh through the nearest points of the surface.

    In 3D, vertices in the fluid give way where bent edges come near. Edges in which surfaces meet stay straight, and
    those of cells too thin to bend.
    """
    seam = on_periodic_surfaces(mesh, len(fluid_domain.bodies), fluid_domain.domain)
    edges, surface = edges_of_facets(mesh, on_kept_surfaces(mesh, fluid_domain) & ~seam)
    apart = ~_on_others(mesh, edges, surface)
    edges, surface = edges[apart], surface[apart]
    straight = mesh.points[edges].mean(axis=1)
    middles = straight.copy()
    for i in np.unique(surface):
        middles[surface == i] = fluid_domain.closest_points(i, straight[surface == i])
    length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
    bends = np.linalg.norm(middles - straight, axis=1) > FLAT * length
    if not bends.any():
        return mesh
    curved = replace(mesh, curved=CurvedEdges(edges[bends], surface[bends], middles[bends]))
    while True:
        if mesh.points.shape[1] == 3:  # in 2D a cell has seldom more than one bent edge, and is left enough of
            curved = smooth_fluid(curved)
        cells = CurvedCells(curved)
        thin = _too_thin(curved, cells, fluid_domain)
        if curved.curved is None or not len(thin):
            return curved
        kept = np.setdiff1d(np.arange(len(curved.curved.surface)), cells.bent[thin])
        curved = replace(curved, curved=_chosen(curved.curved, kept))


def _too_thin(mesh: Mesh, cells: CurvedCells, fluid_domain: FluidDomain) -> IntArray:
    """Numbers of the ``cells`` that are bent too much."""
    left = cells.least_jacobian(mesh.geometry)
    doubtful = np.flatnonzero(left < DOUBTFUL)
    left, vertices = left[doubtful], cells.cells[doubtful]
    corners = mesh.points[vertices]
    pairs = np.array(list(combinations(range(corners.shape[1]), 2)))
    longest = np.linalg.norm(np.diff(corners[:, pairs], axis=2), axis=-1).max(axis=(1, 2), initial=0.0)
    in_a_gap = fluid_domain.gap_widths(corners.mean(axis=1)) < NARROW * longest
    bad = left * cell_quality(mesh.points, vertices) < LEAST_QUALITY
    return np.asarray(doubtful[in_a_gap | bad | (left < SQUEEZED)])


def _chosen(curved: CurvedEdges, kept: IntArray) -> CurvedEdges | None:
    if not len(kept):
        return None
    return CurvedEdges(curved.vertices[kept], curved.surface[kept], curved.middles[kept])


def _on_others(mesh: Mesh, edges: IntArray, surface: IntArray) -> BoolArray:
    """Tell whether each edge (E, 2) is also on facets of surfaces other than its own, ``surface`` (E,); (E,)."""
    shared = np.zeros(len(edges), dtype=bool)
    if mesh.points.shape[1] == 2:
        return shared  # an edge is a facet
    for other in np.unique(mesh.markers):
        theirs, _ = edges_of_facets(mesh, mesh.markers == other)
        shared |= (surface != other) & (edge_numbers(edges, (0, 1), theirs, len(mesh.points)) >= 0)
    return shared
