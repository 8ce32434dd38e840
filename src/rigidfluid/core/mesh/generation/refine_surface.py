"""Bisects edges on bodies and curved walls that are too long for the gap they face; new vertices lie on the exact
surface."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.mesher_unit import significant
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.on_surfaces import put_on_surfaces
from rigidfluid.core.mesh.generation.periodic import on_periodic_surfaces
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.model.types import Mesh

FLAT = 1e-3
"""Quality that a bisected cell must exceed."""


def refine_surface(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> Mesh:
    """Bisect edges of bodies and curved walls, longest first, until none is longer than LONGEST times the wanted size.

    Every cell has at most one edge bisected at a time, so each becomes two. Edges already short enough stay, and so do
    those whose bisection would flatten or invert a cell: in a gap a vertex may be nearer to a facet than the surface
    above it. Since an edge of length L cuts off L²/(8R) of a surface of radius R, and L is at most about the gap, the
    polygon's error stays far below the gap.
    """
    return bisect_all(mesh, lambda now: long_edges(now, fluid_domain, sizes, LONGEST)[:2])


def bisect_all(mesh: Mesh, long: Callable[[Mesh], tuple[IntArray, FloatArray]]) -> Mesh:
    """Bisect the edges (E, 2) that are too ``long``, at the points (E, d) told with them, longest first, until none is
    left but those whose bisection would flatten a cell."""
    refused: set[tuple[int, int]] = set()
    while True:
        edges, middles = long(mesh)
        left = np.array([(a, b) not in refused for a, b in edges.tolist()], dtype=bool)
        if not left.any():
            return mesh
        edges, middles = edges[left], middles[left]
        length = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1)
        chosen = one_per_cell(mesh.cells, edges, length, len(mesh.points))
        edges, middles = edges[chosen], middles[chosen]
        fits = spares_cells(mesh, edges, middles)
        refused |= {(a, b) for a, b in edges[~fits].tolist()}
        if fits.any():
            mesh = bisect(mesh, edges[fits], middles[fits])


def long_edges(
    mesh: Mesh,
    fluid_domain: FluidDomain,
    sizes: Sizes,
    longest: float,
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Edges (E, 2) of bodies and curved walls longer than ``longest`` times the size wanted at their middles; on the
    surface above those, points (E, d) and the size wanted there (E,)."""
    edges, _ = edges_of_facets(mesh, on_kept_surfaces(mesh, fluid_domain))
    periodic, _ = edges_of_facets(mesh, on_periodic_surfaces(mesh, len(fluid_domain.bodies), fluid_domain.domain))
    if len(periodic):
        edges = edges[edge_numbers(edges, (0, 1), periodic, len(mesh.points)) < 0]
    middles = mesh.points[edges].mean(axis=1)
    wanted = wanted_size(middles, fluid_domain, sizes)
    long = np.linalg.norm(mesh.points[edges[:, 0]] - mesh.points[edges[:, 1]], axis=1) > longest * wanted
    edges = edges[long]
    middles = middles_on_surfaces(mesh, edges, fluid_domain)
    return edges, middles, wanted_size(middles, fluid_domain, sizes)


def long_seam_edges(
    mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes, longest: float
) -> tuple[FloatArray, FloatArray]:
    """Middles (E, d) of the edges on periodic surfaces that are longer than ``longest`` times the size wanted there,
    and that size (E,): no vertex can be put there later."""
    edges, _ = edges_of_facets(mesh, on_periodic_surfaces(mesh, len(fluid_domain.bodies), fluid_domain.domain))
    middles, ends = mesh.points[edges].mean(axis=1), mesh.points[edges]
    wanted = wanted_size(middles, fluid_domain, sizes)
    long = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > longest * wanted
    return middles[long], wanted[long]


def middles_on_surfaces(mesh: Mesh, edges: IntArray, fluid_domain: FluidDomain) -> FloatArray:
    """Points (E, d) of the exact surface above the middles of ``edges`` (E, 2), which are sorted; of all that meet
    there."""
    middles = np.asarray(mesh.points[edges].mean(axis=1))
    if not len(edges):
        return middles
    belongs = np.zeros((len(edges), len(fluid_domain.bodies) + len(fluid_domain.domain.pieces)), dtype=bool)
    for pair in combinations(range(mesh.facets.shape[1]), 2):
        number = edge_numbers(mesh.facets, pair, edges, len(mesh.points))
        belongs[number[number >= 0], mesh.markers[number >= 0]] = True
    on_bodies, on_domain = np.split(belongs, [len(fluid_domain.bodies)], axis=1)
    for i in np.flatnonzero(on_bodies.any(axis=0)).tolist():
        middles[on_bodies[:, i]] = fluid_domain.closest_points(i, middles[on_bodies[:, i]])
    there = fluid_domain.domain.wrapped(middles)
    return put_on_surfaces(there, [piece.shape for piece in fluid_domain.domain.pieces], on_domain) + (middles - there)


def on_kept_surfaces(mesh: Mesh, fluid_domain: FluidDomain) -> BoolArray:
    """Tell whether each facet lies on a body or on a surface of the domain that is not flat, or periodic, and that MMG
    must not move, (F,)."""
    bodies, domain = len(fluid_domain.bodies), fluid_domain.domain
    kept = [True] * bodies + [piece.shape.plane is None for piece in domain.pieces]
    return np.array(kept)[mesh.markers] | on_periodic_surfaces(mesh, bodies, domain)


def edges_of_facets(mesh: Mesh, chosen: BoolArray) -> tuple[IntArray, IntArray]:
    """Edges (E, 2) of the ``chosen`` facets (F,), each once with ascending vertex numbers, and their surface's number
    (E,)."""
    facets, markers = mesh.facets[chosen], mesh.markers[chosen]
    pairs = [list(pair) for pair in combinations(range(mesh.facets.shape[1]), 2)]
    edges = np.sort(np.concatenate([facets[:, pair] for pair in pairs]), axis=1)
    edges, index = np.unique(edges, axis=0, return_index=True)
    return edges, np.tile(markers, len(pairs))[index]


def one_per_cell(cells: IntArray, edges: IntArray, length: FloatArray, vertices: int) -> BoolArray:
    """Tell whether each edge is bisected now, (E,): if it is the longest of the given ones in each of its cells."""
    rank = np.empty(len(edges), dtype=np.int64)
    rank[np.argsort(significant(length), kind="stable")] = np.arange(len(edges))
    highest = np.full(len(cells), -1)
    found = [edge_numbers(cells, pair, edges, vertices) for pair in combinations(range(cells.shape[1]), 2)]
    for number in found:
        np.maximum(highest, np.where(number >= 0, rank[number], -1), out=highest)
    chosen = np.ones(len(edges), dtype=bool)
    for number in found:
        chosen[number[(number >= 0) & (rank[number] < highest)]] = False
    return chosen


def spares_cells(mesh: Mesh, edges: IntArray, middles: FloatArray) -> BoolArray:
    """Tell whether each of ``edges`` (E, 2), no two in one cell, can be bisected with all cells above FLAT, (E,)."""
    cells, _ = halved(mesh.cells, edges, len(mesh.points))
    cut = cells[cells.max(axis=1) >= len(mesh.points)]
    flat = cell_quality(np.concatenate([mesh.points, middles]), cut) <= FLAT
    spares = np.ones(len(edges), dtype=bool)
    spares[cut[flat].max(axis=1) - len(mesh.points)] = False
    return spares


def bisect(mesh: Mesh, edges: IntArray, middles: FloatArray) -> Mesh:
    """The mesh with a vertex put at ``middles`` (E, d) into each of ``edges`` (E, 2), of which no cell has two."""
    vertices = len(mesh.points)
    cells, _ = halved(mesh.cells, edges, vertices)
    facets, parent = halved(mesh.facets, edges, vertices)
    return Mesh(np.concatenate([mesh.points, middles]), cells, facets, mesh.markers[parent])


def halved(simplices: IntArray, edges: IntArray, vertices: int) -> tuple[IntArray, IntArray]:
    """Simplices with those that hold one of ``edges`` cut in two at vertex ``vertices`` + edge number; and parents."""
    first, second, parent = simplices.copy(), [simplices], [np.arange(len(simplices))]
    for a, b in combinations(range(simplices.shape[1]), 2):
        number = edge_numbers(simplices, (a, b), edges, vertices)
        cut = np.flatnonzero(number >= 0)
        other = simplices[cut]
        first[cut, a] = other[:, b] = vertices + number[cut]
        second.append(other)
        parent.append(cut)
    second[0] = first
    return np.concatenate(second), np.concatenate(parent)


def edge_numbers(simplices: IntArray, pair: tuple[int, int], edges: IntArray, vertices: int) -> IntArray:
    """Number of each simplex's edge between two of its corners in a sorted list of ``edges``, -1 if not in it, (M,)."""
    low, high = np.sort(simplices[:, pair], axis=1).T
    keys = edges[:, 0] * vertices + edges[:, 1]
    wanted = low * vertices + high
    place = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[place] == wanted, place, -1)
