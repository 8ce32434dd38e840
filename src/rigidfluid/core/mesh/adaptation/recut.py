"""Cuts a periodic mesh open elsewhere: its cells are displaced by periods, and their neighbours stay the same.

A periodic mesh is one of a torus. Its seam, the facets on periodic surfaces, is only where that is cut open, and may be
any facets between cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.distribution import cells_of_facets
from rigidfluid.core.mesh.generation.periodic import Seams
from rigidfluid.core.mesh.topology import REMEDY
from rigidfluid.core.model.types import CurvedEdges, Mesh
from rigidfluid.errors import MeshError


@dataclass(frozen=True)
class Neighbours:
    """Pairs of cells with a common facet on the torus: ``cells`` (P, 2), the corner of each that is ``opposite`` to the
    facet (P, 2), and how many periods the first one's facet is displaced from the second one's, ``apart`` (P, k)."""

    cells: IntArray
    opposite: IntArray
    apart: IntArray


def recut(mesh: Mesh, seams: Seams, shift: IntArray) -> Mesh:
    """The same periodic mesh with each cell displaced by its ``shift`` (M, k), in periods.

    Cells keep their order, and facets of bodies and walls go with their cell. The facets between neighbours that are
    no longer in the same period become the periodic ones; they may be apart in one direction alone.
    """
    root, offset = seams.originals(mesh)
    placed = offset[mesh.cells] + shift[:, None]
    keys = np.column_stack([root[mesh.cells.ravel()], placed.reshape(-1, placed.shape[2])])
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    way = shift @ seams.ways
    points = mesh.points[mesh.cells.ravel()[first]] + way[first // mesh.cells.shape[1]]
    cells = number.reshape(mesh.cells.shape).astype(np.int64)
    own = ~np.isin(mesh.markers, seams.surfaces)
    carried = _in_cells(mesh.facets[own], cells_of_facets(mesh)[own], mesh.cells, cells)
    seam, markers = _seam(cells, neighbours(mesh, seams), shift, seams)
    facets = np.concatenate([carried, seam])
    curved = None if mesh.curved is None else _curves(mesh.curved, mesh.cells, cells, way)
    return Mesh(points, cells, facets, np.concatenate([mesh.markers[own], markers]), curved=curved)


def neighbours(mesh: Mesh, seams: Seams) -> Neighbours:
    """All pairs of neighbours in the mesh and across its seam."""
    root, offset = seams.originals(mesh)
    corners = mesh.cells.shape[1]
    picks = np.array(list(combinations(range(corners), corners - 1)))
    opposite = np.array([corners * (corners - 1) // 2 - pick.sum() for pick in picks])
    vertices = mesh.cells[:, picks].reshape(-1, corners - 1)
    key, base = _torus_keys(root[vertices], offset[vertices])
    _, group, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(group.ravel(), kind="stable")
    order = order[count[group.ravel()[order]] == 2].reshape(-1, 2)
    return Neighbours(order // len(picks), opposite[order % len(picks)], base[order[:, 0]] - base[order[:, 1]])


def _torus_keys(root: IntArray, offset: IntArray) -> tuple[IntArray, IntArray]:
    """Rows (F, ·) that are equal for facets which are equal but for periods, and how many periods each is displaced
    (F, k), of facets with vertices at an ``offset`` (F, d, k) of their ``root`` (F, d)."""
    facets, corners, periods = offset.shape
    by = np.repeat(np.arange(facets), corners)
    order = np.lexsort([*(offset[:, :, p].ravel() for p in reversed(range(periods))), root.ravel(), by])
    sorted_root = root.ravel()[order].reshape(facets, corners)
    sorted_offset = offset.reshape(-1, periods)[order].reshape(facets, corners, periods)
    base = sorted_offset[:, 0]
    relative = (sorted_offset - base[:, None]).reshape(facets, -1)
    return np.concatenate([sorted_root, relative], axis=1), base


def _seam(cells: IntArray, pairs: Neighbours, shift: IntArray, seams: Seams) -> tuple[IntArray, IntArray]:
    """Facets (F, d) between neighbours that are periods apart, and their markers (F,)."""
    apart = pairs.apart + shift[pairs.cells[:, 0]] - shift[pairs.cells[:, 1]]
    cut = np.flatnonzero(apart.any(axis=1))
    apart = apart[cut]
    if (np.abs(apart).sum(axis=1) > 1).any():
        found = "a cell more than one period from its neighbour"
        raise MeshError("mesh", found, "a seam along one pair of periodic surfaces at a time", REMEDY)
    pair, sign = np.argmax(np.abs(apart), axis=1), apart.sum(axis=1)
    facets, markers = [], []
    for side, ahead in ((0, sign > 0), (1, sign < 0)):
        facets.append(_facets_opposite(cells[pairs.cells[cut, side]], pairs.opposite[cut, side]))
        markers.append(np.where(ahead, seams.second[pair], seams.first[pair]))
    return np.concatenate(facets), np.concatenate(markers)


def _facets_opposite(cells: IntArray, corner: IntArray) -> IntArray:
    """The facet (F, d) of each of some ``cells`` (F, d+1) opposite to a ``corner`` (F,)."""
    rest = np.arange(cells.shape[1]) != corner[:, None]
    return np.asarray(cells[rest].reshape(len(cells), -1))


def _in_cells(simplices: IntArray, cell: IntArray, old: IntArray, new: IntArray) -> IntArray:
    """Simplices (F, c), each in a ``cell`` (F,) of the ``old`` cells, by the vertices of the ``new`` ones."""
    corner = np.argmax(simplices[:, :, None] == old[cell][:, None, :], axis=2)
    return np.take_along_axis(new[cell], corner, axis=1)


def _curves(curved: CurvedEdges, old: IntArray, new: IntArray, way: FloatArray) -> CurvedEdges:
    """Curved edges of the ``old`` cells on the ``new`` ones, which are displaced by their ``way`` (M, d)."""
    pairs = np.array(list(combinations(range(old.shape[1]), 2)))
    before, after = np.sort(old[:, pairs].reshape(-1, 2), axis=1), np.sort(new[:, pairs].reshape(-1, 2), axis=1)
    size = int(old.max()) + 1
    edges = np.sort(curved.vertices, axis=1) @ np.array([size, 1])
    order, keys = np.argsort(edges), before @ np.array([size, 1])
    place = order[np.minimum(np.searchsorted(edges, keys, sorter=order), len(edges) - 1)]
    bent = np.flatnonzero(edges[place] == keys)
    vertices, index = np.unique(after[bent], axis=0, return_index=True)
    place, cell = place[bent[index]], bent[index] // len(pairs)
    return CurvedEdges(vertices, curved.surface[place], curved.middles[place] + way[cell])
