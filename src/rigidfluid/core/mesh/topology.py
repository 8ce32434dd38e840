"""Facets and boundary of a mesh of simplices, and the checks that every new mesh must pass."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, IntArray
from rigidfluid.core.geometry.facets import area_vectors
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.model.types import Mesh
from rigidfluid.errors import MeshError

REMEDY = "Choose a finer [mesh] size_body or a coarser [mesh] size, or move the bodies further apart."

_ROUNDINGS = 16.0
"""Roundings of a coordinate, of ε max|x| each, that a vertex of the boundary may be away from its place."""


def boundary_facets(cells: IntArray) -> IntArray:
    """Facets that belong to one cell only, (F, d), vertex numbers ascending, rows in lexicographic order."""
    corners = np.sort(cells, axis=1)
    picks = np.array(list(combinations(range(cells.shape[1]), cells.shape[1] - 1)))
    facets, count = _distinct(corners[:, picks].reshape(-1, cells.shape[1] - 1))
    boundary: IntArray = facets[count == 1]
    return boundary


def distinct_edges(cells: IntArray) -> IntArray:
    """Edges of cells, (E, 2), vertex numbers ascending, rows in lexicographic order."""
    corners = np.sort(cells, axis=1)
    pairs = np.array(list(combinations(range(cells.shape[1]), 2)))
    return _distinct(corners[:, pairs].reshape(-1, 2))[0]


def orient(mesh: Mesh) -> Mesh:
    """The same mesh with two vertices exchanged in every cell of negative volume."""
    cells = mesh.cells.copy()
    inverted = cell_volumes(mesh.points, cells) < 0.0
    cells[inverted, :2] = cells[inverted, 1::-1]
    return Mesh(mesh.points, cells, mesh.facets, mesh.markers)


def share_no_cell(cells: IntArray, chosen: IntArray, vertices: int) -> BoolArray:
    """Tell whether each of the ``chosen`` vertices is the first of them in all its cells, (E,), so that no cell has two
    with True; ``vertices`` is the number of all."""
    rank = np.full(vertices, len(chosen))
    np.minimum.at(rank, chosen, np.arange(len(chosen)))
    least = rank[cells].min(axis=1)
    around = np.full(vertices, len(chosen))
    for corner in cells.T:
        np.minimum.at(around, corner, least)
    return np.asarray(around[chosen] == np.arange(len(chosen)))


def check_mesh(mesh: Mesh, quality: float) -> None:
    """Raise MeshError unless the marked facets are exactly the boundary of the cells, and every cell is above a
    ``quality`` of at least 0."""
    listed, _ = _distinct(np.sort(mesh.facets, axis=1))
    boundary = boundary_facets(mesh.cells)
    if len(listed) != len(mesh.facets) or not np.array_equal(listed, boundary):
        found = f"{len(mesh.facets)} marked facets around cells with {len(boundary)} boundary facets"
        raise MeshError("mesh", found, "the same facets in both", REMEDY)
    cell = int(np.argmin(worst := cell_quality(mesh.points, mesh.cells)))
    if worst[cell] <= quality:
        where = np.array2string(mesh.points[mesh.cells[cell]].mean(axis=0), precision=4)
        raise MeshError(f"mesh near {where}", f"a cell of quality {worst[cell]:.3g}", f"more than {quality:g}", REMEDY)


def check_volume(mesh: Mesh, expected: float, whose: str) -> None:
    """Refuse a mesh whose cells fill another volume than ``expected`` [length^d], that ``whose`` says.

    All that may differ is how rounding of the coordinates moves the boundary, _ROUNDINGS ε max|x| times its area.
    """
    volume = float(cell_volumes(mesh.points, mesh.cells).sum())
    area = float(np.linalg.norm(area_vectors(mesh.points, mesh.facets), axis=1).sum())
    allowed = _ROUNDINGS * np.finfo(float).eps * float(np.abs(mesh.points).max()) * area
    if abs(volume - expected) > allowed:
        found = f"cells of a volume that is {volume - expected:.3g} off the {expected!r} {whose}"
        raise MeshError("mesh", found, f"at most {allowed:.3g}, by rounding", REMEDY)


def _distinct(rows: IntArray) -> tuple[IntArray, IntArray]:
    """Distinct ``rows`` (N, k) in lexicographic order, and how often each is there.

    Each row is sorted as one number: NumPy takes ten times as long to sort rows.
    """
    shape = (int(rows.max(initial=0)) + 1,) * rows.shape[1]
    keys, count = np.unique(np.ravel_multi_index(tuple(rows.T), shape), return_counts=True)
    return np.stack(np.unravel_index(keys, shape), axis=1), count
