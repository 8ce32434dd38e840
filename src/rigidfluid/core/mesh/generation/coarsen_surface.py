"""Takes vertices off bodies whose facets are much finer than wanted, by edge collapses: undoes `refine_surface`.

Facets that were bisected for a gap stay when it has opened, as MMG keeps all facets of bodies. In 3D a single contact
leaves twice the cells behind, and every contact adds its own.
"""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.mesher_unit import significant
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.refine_surface import edges_of_facets
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.mesh.topology import check_mesh, share_no_cell
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

SHORTEST = 0.5
"""An edge on a body is collapsed when it is shorter than this many times the wanted size."""

PER_RADIUS = 2.0
"""Edges as long as a body's least radius of curvature over this are wanted anyway, as Netgen makes them."""

LEAST_QUALITY = 0.1
"""Least quality of the cells that a collapse has changed, or that of the worst of them before, if it is less."""

MOST_TURNED = 0.5
"""Cosine of the largest angle by which a facet may turn in a collapse."""


def coarsen_surface(mesh: Mesh, fluid_domain: FluidDomain, sizes: Sizes) -> Mesh:
    """Collapse edges of smooth bodies in 3D that are too short, shortest first, until none can be collapsed.

    One end of the edge is taken off the mesh and its cells are drawn to the other one, which stays where it is, on the
    exact surface. No cell is changed by two collapses at a time. An edge stays where a cell would get worse than
    LEAST_QUALITY and than all there, a facet would turn too far or get an edge that is too long, or the surface would
    fold. The mesh is returned unchanged if no edge is too short, or if the result is not closed by its facets.
    """
    given = mesh
    longest = np.array(
        [0.0 if body.least_radius is None else body.least_radius / PER_RADIUS for body in fluid_domain.bodies]
    )
    refused: set[tuple[int, int]] = set()
    while True:
        pairs, wanted = _short_edges(mesh, longest, fluid_domain, sizes)
        left = np.array([(a, b) not in refused for a, b in pairs.tolist()], dtype=bool)
        if not left.any():
            break
        pairs, wanted = pairs[left], wanted[left]
        apart = share_no_cell(mesh.cells, pairs[:, 0], len(mesh.points))
        pairs, wanted = pairs[apart], wanted[apart]
        fits = _can_collapse(mesh, pairs, wanted)
        refused |= {(a, b) for a, b in pairs[~fits].tolist()}
        if fits.any():
            mesh, number = _collapsed(mesh, pairs[fits])
            refused = {(int(number[a]), int(number[b])) for a, b in refused if number[a] >= 0 and number[b] >= 0}
    try:
        check_mesh(mesh, quality=0.0)
    except MeshError:
        return given
    return mesh


def _short_edges(
    mesh: Mesh, longest: FloatArray, fluid_domain: FluidDomain, sizes: Sizes
) -> tuple[IntArray, FloatArray]:
    """Short edges as pairs (E, 2) of the vertex to take off and the one that stays, each edge in both directions, and
    the wanted size (E,), at most ``longest`` (n,) on their body; sorted by length over wanted size."""
    on_smooth = np.zeros(mesh.markers.max() + 1, dtype=bool)
    on_smooth[: len(longest)] = longest > 0.0
    edges, body = edges_of_facets(mesh, on_smooth[mesh.markers])
    ends = mesh.points[edges]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    short = np.flatnonzero(length < SHORTEST * sizes.size_body)
    wanted = np.minimum(wanted_size(ends[short].mean(axis=1), fluid_domain, sizes), longest[body[short]])
    relative = significant(length[short] / wanted)
    order = np.argsort(relative, kind="stable")
    chosen = order[relative[order] < SHORTEST]
    edges = edges[short[chosen]]
    return np.stack([edges, edges[:, ::-1]], axis=1).reshape(-1, 2), np.repeat(wanted[chosen], 2)


def _can_collapse(mesh: Mesh, pairs: IntArray, wanted: FloatArray) -> BoolArray:
    """Tell whether each of the ``pairs`` (E, 2), which change no cell twice, can be collapsed, (E,); edges are to be
    ``wanted`` (E,) long."""
    pair_of = np.full(len(mesh.points), -1)
    pair_of[pairs[:, 0]] = np.arange(len(pairs))
    target = _targets(mesh, pairs)
    can_collapse = np.ones(len(pairs), dtype=bool)
    cell, number = _changed(mesh.cells, pair_of)
    drawn = target[mesh.cells[cell]]
    stays = ~_degenerate(drawn)
    least = np.full(len(pairs), LEAST_QUALITY)
    np.minimum.at(least, number, cell_quality(mesh.points, mesh.cells[cell]))
    can_collapse[number[stays][cell_quality(mesh.points, drawn[stays]) < least[number[stays]]]] = False
    facet, number = _changed(mesh.facets, pair_of)
    drawn = target[mesh.facets[facet]]
    gone = _degenerate(drawn)
    can_collapse &= np.bincount(number[gone], minlength=len(pairs)) == 2  # with more the surface would fold
    before, after, number = mesh.points[mesh.facets[facet[~gone]]], mesh.points[drawn[~gone]], number[~gone]
    turned = np.sum(_normals(before) * _normals(after), axis=1) < MOST_TURNED
    longest = np.linalg.norm(after - np.roll(after, 1, axis=1), axis=2).max(axis=1)
    can_collapse[number[turned | (longest > LONGEST * wanted[number])]] = False
    return can_collapse


def _collapsed(mesh: Mesh, pairs: IntArray) -> tuple[Mesh, IntArray]:
    """The mesh after the collapses, and the new number of each vertex, -1 of those that are gone."""
    target = _targets(mesh, pairs)
    cells, facets = target[mesh.cells], target[mesh.facets]
    cells, left = cells[~_degenerate(cells)], ~_degenerate(facets)
    kept = target == np.arange(len(target))
    number = np.cumsum(kept) - 1
    new = Mesh(mesh.points[kept], number[cells], number[facets[left]], mesh.markers[left])
    return new, np.where(kept, number, -1)


def _targets(mesh: Mesh, pairs: IntArray) -> IntArray:
    """Vertex that each vertex is drawn to, (N,): itself unless one of the ``pairs`` (E, 2) takes it off."""
    target = np.arange(len(mesh.points))
    target[pairs[:, 0]] = pairs[:, 1]
    return target


def _changed(simplices: IntArray, pair_of: IntArray) -> tuple[IntArray, IntArray]:
    """Simplices with a vertex that is taken off, and the number of its pair, which ``pair_of`` (N,) gives for each
    vertex, -1 for those that stay; no simplex has two."""
    number = pair_of[simplices].max(axis=1)
    changed = np.flatnonzero(number >= 0)
    return changed, number[changed]


def _degenerate(simplices: IntArray) -> BoolArray:
    """Tell whether each simplex has a vertex twice, (M,)."""
    ordered = np.sort(simplices, axis=1)
    return np.asarray((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))


def _normals(triangles: FloatArray) -> FloatArray:
    """Unit normals of triangles (M, 3, 3)."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))
