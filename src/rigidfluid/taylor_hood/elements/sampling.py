"""Values of finite-element fields at given points, also where other processes hold the cells there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.quadratic_cells import quadratic_basis
from rigidfluid.core.mesh.location import CellFinder
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.location import barycentric, located
from rigidfluid.taylor_hood.elements.numbering import Numbering


@dataclass(frozen=True)
class _Served:
    """Points that one process asked for and found here: ``cell`` (N,) and barycentric ``coordinates`` (N, d+1)."""

    cell: IntArray
    coordinates: FloatArray


class Samples:
    """Fields on a mesh, evaluated at ``targets`` (N, d) of this process; outside the mesh in the nearest cell.

    On a mesh with periods they are evaluated at the targets' images there, which are so many ``periods`` (N, k) ahead.
    """

    def __init__(self, mesh: Mesh, numbering: Numbering, targets: FloatArray) -> None:
        self._numbering, self._ranks, self._count = numbering, mesh.ranks, len(targets)
        self.periods = np.zeros((len(targets), 0), dtype=np.int64)
        if mesh.periods is not None:
            ways = mesh.periods.ways
            self.periods = CellFinder(mesh.points, mesh.cells).periods_ahead(targets, ways)
            targets = targets + self.periods @ ways
        asked = _candidates(mesh, targets)
        answers = [_located(mesh, numbering, points) for points in self._ranks.alltoall([targets[to] for to in asked])]
        depths = self._ranks.alltoall([depth for _, depth in answers])
        chosen = _deepest(asked, depths, len(targets))
        self._places = [np.flatnonzero(chosen == rank) for rank in range(self._ranks.size)]
        wanted = self._ranks.alltoall([chosen[to] == rank for rank, to in enumerate(asked)])
        self._served = [
            _Served(found.cell[keep], found.coordinates[keep]) for (found, _), keep in zip(answers, wanted, strict=True)
        ]

    def quadratic(self, field: FloatArray) -> FloatArray:
        """A P2 field given at the nodes, (N, …)."""
        nodes = self._numbering.cell_nodes
        return self._returned([
            np.einsum("ni,ni...->n...", quadratic_basis(one.coordinates), field[nodes[one.cell]])
            for one in self._served
        ])  # fmt: skip

    def linear(self, field: FloatArray) -> FloatArray:
        """A P1 field given at the vertices, (N, …)."""
        cells = self._numbering.cells
        return self._returned(
            [np.einsum("ni,ni...->n...", one.coordinates, field[cells[one.cell]]) for one in self._served]
        )

    def _returned(self, values: list[FloatArray]) -> FloatArray:
        result = np.empty((self._count, *values[0].shape[1:]))
        for place, found in zip(self._places, self._ranks.alltoall(values), strict=True):
            result[place] = found
        return result


def _located(mesh: Mesh, numbering: Numbering, points: FloatArray) -> tuple[_Served, FloatArray]:
    """Each point's cell of this part, and how deep in it it is: the least barycentric coordinate (N,)."""
    cell, coordinates = located(CellFinder(mesh.points, mesh.cells), numbering, mesh.geometry, points)
    if mesh.part is None:
        return _Served(cell, coordinates), np.zeros(len(points))
    depth = barycentric(mesh.points, mesh.cells[cell], points).min(axis=1)
    return _Served(cell, coordinates), depth


def _candidates(mesh: Mesh, targets: FloatArray) -> list[IntArray]:
    """Targets that each process may hold: those in its box, and those in nobody's that are nearest to it."""
    if mesh.part is None:
        return [np.arange(len(targets))]
    boxes = mesh.ranks.allgather((mesh.points.min(axis=0), mesh.points.max(axis=0)))
    beyond = np.stack([np.maximum(lower - targets, targets - upper).max(axis=1) for lower, upper in boxes])
    margin = 1e-3 * max(float((upper - lower).max()) for lower, upper in boxes)
    asked: BoolArray = beyond <= np.maximum(beyond.min(axis=0), margin)
    return [np.flatnonzero(row) for row in asked]


def _deepest(asked: list[IntArray], depths: list[FloatArray], count: int) -> IntArray:
    """The process in whose cell each target is deepest, the lowest of equals (N,)."""
    if len(asked) == 1:
        return np.zeros(count, dtype=np.int64)
    table = np.full((len(asked), count), -np.inf)
    for row, to, depth in zip(table, asked, depths, strict=True):
        row[to] = depth
    return np.asarray(np.argmax(table, axis=0))
