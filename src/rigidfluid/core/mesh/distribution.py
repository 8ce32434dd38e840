"""Cuts a mesh into a part for each rank, and puts the parts together again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.model.ranks import ALONE, Ranks
from rigidfluid.core.model.types import CurvedEdges, Mesh, MeshPart

_Piece = tuple[tuple[NDArray[Any], ...], CurvedEdges | None]


def partition(mesh: Mesh, parts: int) -> IntArray:
    """Part of each cell (M,), from 0 to ``parts`` - 1, by halving the cells' centres across their longest extent.

    Parts differ by one cell at most for each halving. Recursive coordinate bisection, Berger and Bokhari (1987), DOI
    10.1109/TC.1987.1676942.
    """
    owner = np.zeros(len(mesh.cells), dtype=np.int64)
    _halve(mesh.points[mesh.cells].mean(axis=1), np.arange(len(mesh.cells)), 0, parts, owner)
    return owner


def distributed(mesh: Mesh, ranks: Ranks) -> Mesh:
    """Part of the root's ``mesh`` that this rank gets, with all vertices of its cells, both in the order of the whole;
    alone, the very mesh. No other rank's mesh is read."""
    if ranks.size == 1:
        return mesh
    return shared(ranks.scatter(parts_of(mesh, partition(mesh, ranks.size)) if ranks.is_root else None), ranks)


def shared(part: Mesh, ranks: Ranks) -> Mesh:
    """A part that `parts_of` has cut, held by one of these ``ranks``; a whole mesh stays one."""
    return part if part.part is None else replace(part, part=replace(part.part, ranks=ranks))


def parts_of(mesh: Mesh, owner: IntArray) -> list[Mesh]:
    """All parts of a whole mesh, cells by their ``owner`` (M,) from 0 on, for ranks yet to be named; one part is the
    mesh itself."""
    count = int(owner.max()) + 1
    if count == 1:
        return [mesh]
    facet_owner = owner[cells_of_facets(mesh)]
    vertices = [np.unique(mesh.cells[owner == rank]) for rank in range(count)]
    lowest = np.empty(len(mesh.points), dtype=np.int64)
    for rank in reversed(range(count)):
        lowest[vertices[rank]] = rank
    return [
        _part(mesh, vertices[rank], np.flatnonzero(owner == rank), np.flatnonzero(facet_owner == rank), lowest == rank)
        for rank in range(count)
    ]


def whole(mesh: Mesh) -> Mesh | None:
    """The mesh that the parts were cut from, with the points where they are now, on the root; None for the others."""
    if mesh.part is None:
        return mesh
    pieces = mesh.ranks.gather(_piece(mesh))
    return None if pieces is None else replace(_joined(pieces), periods=mesh.periods)


def joined(parts: Sequence[Mesh]) -> Mesh:
    """Join all parts of a mesh, in the order of ranks, to the `whole`."""
    if len(parts) == 1:
        return parts[0]
    return replace(_joined([_piece(part) for part in parts]), periods=parts[0].periods)


def _piece(mesh: Mesh) -> _Piece:
    """Contribution of a part to the whole: owned vertices, cells and facets by their numbers there, and curved
    edges."""
    assert mesh.part is not None
    part, own = mesh.part, mesh.part.owned
    curved = None if mesh.curved is None else replace(mesh.curved, vertices=part.vertices[mesh.curved.vertices])
    arrays = (
        *(part.vertices[own], mesh.points[own], part.cells, part.vertices[mesh.cells]),
        *(part.facets, part.vertices[mesh.facets], mesh.markers),
    )
    return arrays, curved


def _joined(pieces: Sequence[_Piece]) -> Mesh:
    arrays, curved = zip(*pieces, strict=True)
    vertices, points, cells, corners, facets, facet_corners, markers = map(np.concatenate, zip(*arrays, strict=True))
    vertex, cell, facet = np.argsort(vertices), np.argsort(cells), np.argsort(facets)
    curves = _joined_curves([piece for piece in curved if piece is not None])
    return Mesh(points[vertex], corners[cell], facet_corners[facet], markers[facet], curved=curves)


def _joined_curves(pieces: Sequence[CurvedEdges]) -> CurvedEdges | None:
    """All parts' curved edges, each once."""
    if not pieces:
        return None
    vertices, surface, middles = (
        np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("vertices", "surface", "middles")
    )
    _, first = np.unique(vertices, axis=0, return_index=True)
    return CurvedEdges(vertices[first], surface[first], middles[first])


def surface_vertices(mesh: Mesh, surface: int) -> IntArray:
    """Own numbers of the vertices on a surface, (s,), ascending; also where the facet is in another rank's part."""
    own: IntArray = np.unique(mesh.facets[mesh.markers == surface])
    if mesh.part is None:
        return own
    anywhere = np.concatenate(mesh.part.ranks.allgather(mesh.part.vertices[own]))
    return np.flatnonzero(np.isin(mesh.part.vertices, anywhere))


def _halve(centres: FloatArray, cells: IntArray, first: int, parts: int, owner: IntArray) -> None:
    """Number the ``cells`` of ``owner`` from ``first`` on."""
    owner[cells] = first
    if parts > 1:
        axis = int(np.argmax(np.ptp(centres[cells], axis=0)))
        along, half = cells[np.argsort(centres[cells, axis], kind="stable")], parts // 2
        cut = len(cells) * half // parts
        _halve(centres, along[:cut], first, half, owner)
        _halve(centres, along[cut:], first + half, parts - half, owner)


def _part(mesh: Mesh, vertices: IntArray, cells: IntArray, facets: IntArray, owned: BoolArray) -> Mesh:
    counts = np.array([len(mesh.points), len(mesh.cells), len(mesh.facets)])
    own_cells = np.searchsorted(vertices, mesh.cells[cells])
    return Mesh(
        points=mesh.points[vertices],
        cells=own_cells,
        facets=np.searchsorted(vertices, mesh.facets[facets]),
        markers=mesh.markers[facets],
        part=MeshPart(ALONE, vertices, cells, facets, owned[vertices], counts),
        curved=_part_of_curves(mesh.curved, vertices, own_cells),
        periods=mesh.periods,
    )


def _part_of_curves(curved: CurvedEdges | None, vertices: IntArray, cells: IntArray) -> CurvedEdges | None:
    """Curved edges at a part's ``cells``, by the part's own numbers of its ``vertices``; None where there are none."""
    if curved is None:
        return None
    inside = np.isin(curved.vertices, vertices).all(axis=1)
    edges = np.searchsorted(vertices, curved.vertices[inside])
    pairs = np.sort(cells[:, list(combinations(range(cells.shape[1]), 2))].reshape(-1, 2), axis=1)
    count = len(vertices)
    held = np.isin(edges[:, 0] * count + edges[:, 1], pairs[:, 0] * count + pairs[:, 1])
    if not held.any():
        return None
    return CurvedEdges(edges[held], curved.surface[inside][held], curved.middles[inside][held])


def cells_of_facets(mesh: Mesh) -> IntArray:
    """The cell that each boundary facet belongs to, (F,): the one that has all of its vertices."""
    cells, facets = (_incidence(simplices, len(mesh.points)) for simplices in (mesh.cells, mesh.facets))
    common = (facets @ cells.T).tocoo()
    whole_facet = common.data == mesh.facets.shape[1]
    found = np.empty(len(mesh.facets), dtype=np.int64)
    found[common.coords[0][whole_facet]] = common.coords[1][whole_facet]
    return found


def _incidence(simplices: IntArray, vertices: int) -> csr_array:
    """1 where a simplex has a vertex, (simplices, vertices)."""
    start = np.arange(0, simplices.size + 1, simplices.shape[1])
    return csr_array((np.ones(simplices.size), simplices.ravel(), start), shape=(len(simplices), vertices))
