"""Moves vertices in the fluid off bad cells, where edges bend or MMG has left a sliver."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mesh.generation.curved_cells import CurvedCells
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.topology import share_no_cell
from rigidfluid.core.model.types import Mesh

GOOD_QUALITY = 0.3
"""Vertices of cells below this quality are moved. A mesh is regenerated at half of its worst cell's, well above 0.1."""

FIRST, LAST = 0.2, 0.05
"""Lengths of the first and the last moves that are tried, over the shortest edge at the vertex."""

LEAST_GAIN = 1e-3
"""A move must make the worst cell so much better. Moves that differ by round-off alone, as in a symmetric mesh, are
thus decided by their order."""


def smooth_fluid(mesh: Mesh) -> Mesh:
    """Move vertices that lie on no surface until their cells are good, or no move makes the worst of them better.

    Each vertex tries moves along the axes and the diagonals and takes the best one, and then shorter ones where none is
    better. No cell has two of its vertices moved at a time, so that no cell gets worse than the worst around it. The
    mesh must be whole; its curved edges count as they are bent.
    """
    near, movable = _around_bad_cells(mesh)
    geometry, step = mesh.geometry.copy(), FIRST * _shortest_edges(mesh.points, near.cells)
    shortest = LAST / FIRST * step
    worst_near = _worst_at_vertices(near)
    while True:
        before = worst_near(geometry)
        movable = movable[(before[movable] < GOOD_QUALITY) & (step[movable] >= shortest[movable])]
        if not len(movable):
            return mesh.moved_to(geometry)
        moved = movable[share_no_cell(near.cells, movable, len(mesh.points))]
        worst = _worst_at_vertices(_with_cells_at(near, moved))
        start, best, reached = geometry[moved].copy(), before[moved] + LEAST_GAIN, geometry[moved].copy()
        for direction in _directions(mesh.points.shape[1]):
            geometry[moved] = start + step[moved, None] * direction
            now = worst(geometry)[moved]
            better = now > best
            reached[better], best[better] = geometry[moved[better]], now[better] + LEAST_GAIN
        geometry[moved] = reached
        step[moved[(reached == start).all(axis=1)]] *= 0.5


def _directions(dimension: int) -> FloatArray:
    """Unit vectors along the axes and the diagonals, (3^d - 1, d)."""
    directions = np.array([one for one in product((-1.0, 0.0, 1.0), repeat=dimension) if any(one)])
    return np.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


def _around_bad_cells(mesh: Mesh) -> tuple[Mesh, IntArray]:
    """The mesh with no other cells than those at the vertices of bad cells that can be moved, and these vertices."""
    cells = CurvedCells(mesh)
    bad = mesh.cells[cell_quality(mesh.points, mesh.cells) < GOOD_QUALITY]
    bent = cells.cells[cells.quality(mesh.geometry) < GOOD_QUALITY]
    movable = np.setdiff1d(np.concatenate([bad, bent]), mesh.facets)
    return _with_cells_at(mesh, movable), movable


def _with_cells_at(mesh: Mesh, vertices: IntArray) -> Mesh:
    """The mesh with no other cells than those at these ``vertices``."""
    chosen = np.zeros(len(mesh.points), dtype=bool)
    chosen[vertices] = True
    return replace(mesh, cells=mesh.cells[chosen[mesh.cells].any(axis=1)])


def _worst_at_vertices(mesh: Mesh) -> Callable[[FloatArray], FloatArray]:
    """Quality of each vertex's worst cell, bent ones included, as a function of the geometry (N,)."""
    cells = CurvedCells(mesh)
    every = np.concatenate([mesh.cells, cells.cells])

    def worst(geometry: FloatArray) -> FloatArray:
        quality = np.concatenate([cell_quality(geometry, mesh.cells), cells.quality(geometry)])
        return _least_at_vertices(every, quality, len(mesh.points))

    return worst


def _shortest_edges(points: FloatArray, cells: IntArray) -> FloatArray:
    """Shortest edge of the ``cells`` at each vertex, infinite at others, (N,) [length]."""
    first, second = np.triu_indices(cells.shape[1], 1)
    length = np.linalg.norm(points[cells[:, first]] - points[cells[:, second]], axis=2).min(axis=1, initial=np.inf)
    return _least_at_vertices(cells, length, len(points))


def _least_at_vertices(cells: IntArray, values: FloatArray, vertices: int) -> FloatArray:
    """Least of the ``values`` (M,) of the ``cells`` at each vertex, infinite where none is (N,)."""
    least = np.full(vertices, np.inf)
    for corner in cells.T:
        np.minimum.at(least, corner, values)
    return least
