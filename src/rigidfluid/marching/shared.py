"""A mesh that ranks hold in parts, as one of them has it: its own cells, and all of the boundary."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Mesh, MeshPart
from rigidfluid.marching.adjacency import inner_vertices, rows_of
from rigidfluid.marching.band import longest_edges
from rigidfluid.marching.field import Band
from rigidfluid.marching.partition import Halted, PlacedPart, Reached, march_side_by_side, part_of
from rigidfluid.marching.topology import Neighbours, Numbers


class Gaps(NamedTuple):
    """Gaps of facets to bodies: number of the ``pair`` (c,) of surfaces, the ``facet`` (c,), the ``gap`` (c,) [length]
    and the body's own facet where it is reached, the ``partner`` (c,)."""

    pair: IntArray
    facet: Numbers
    gap: FloatArray
    partner: Numbers

    def select(self, rows: IntArray) -> Gaps:
        """Gaps of these ``rows``, in their order."""
        return Gaps(self.pair[rows], self.facet[rows], self.gap[rows], self.partner[rows])


def joined_gaps(parts: Sequence[Gaps]) -> Gaps:
    """Gaps of several parts, at least one, joined."""
    return Gaps(*map(np.concatenate, zip(*parts, strict=True)))


NO_GAPS = Gaps(np.empty(0, np.int64), np.empty(0, np.int32), np.empty(0), np.empty(0, np.int32))


class SharedMesh:
    """One rank's cells of a mesh with the whole boundary; made and used by all ranks together.

    Facets have their numbers in the whole mesh; no cell of another rank is known.
    """

    def __init__(self, mesh: Mesh) -> None:
        own = mesh.part
        assert own is not None
        self.mesh, self._ranks = mesh, mesh.ranks
        facets, markers, across = _whole_boundary(mesh, own)
        shared = np.concatenate(self._ranks.allgather(own.vertices[~own.owned]))
        self.part = part_of(own.vertices[mesh.cells], facets, markers, across, shared)
        self._has_facet = np.zeros(len(facets), dtype=bool)
        self._has_facet[own.facets] = True
        # each rank sends where its vertices of the boundary are; what all receive goes to these rows of the part
        self._sent = np.flatnonzero(own.owned & np.isin(own.vertices, np.append(facets, across)))
        received = np.concatenate(self._ranks.allgather(own.vertices[self._sent]))
        order = np.argsort(self.part.vertices)
        self._received_rows = order[np.searchsorted(self.part.vertices, received, sorter=order)]
        border = own.vertices[self.part.border]
        # by rank the row in its border of each vertex of this one's, or -1, as for itself
        self._rows_there = [_rows_in(theirs, border) for theirs in self._ranks.allgather(border)]
        self._rows_there[self._ranks.rank][:] = -1

    def facets_of(self, surface: int) -> Numbers:
        """Facets of a surface that are of this rank's cells."""
        facets = self.part.topology.facets_of(surface)
        return facets[self._has_facet[facets]]

    def points(self, mesh: Mesh) -> FloatArray:
        """Present coordinates of the vertices of the part and of the boundary, (n, d) [length]."""
        points = np.empty((len(self.part.vertices), mesh.points.shape[1]))
        points[: len(mesh.points)] = mesh.points
        points[self._received_rows] = np.concatenate(self._ranks.allgather(mesh.points[self._sent]))
        return points

    def neighbours(self, points: FloatArray) -> Neighbours:
        """Neighbours in the part, with the longest edges elsewhere, for vertices at ``points`` (n, d) [length]."""
        own, border = self.part.topology.adjacency.neighbours, self.part.border
        elsewhere, rows = np.zeros(len(points)), np.arange(len(border))
        for row, square in self._ranks.alltoall(self._addressed(rows, longest_edges(points, own, border))):
            elsewhere[border[row]] = np.maximum(elsewhere[border[row]], square)
        return own._replace(elsewhere=elsewhere)

    def march(self, points: FloatArray, sources: Sequence[Sequence[int]], band: Band) -> list[Halted | None]:
        """This part of several fields, as `march_side_by_side` has it, for vertices at ``points`` (n, d) [length]."""
        placed = PlacedPart(self.part, points, self.neighbours(points))
        return march_side_by_side(placed, sources, band, self._exchange)

    def gather(self, gaps: Gaps) -> Gaps:
        """Gaps that all ranks have found."""
        return joined_gaps(self._ranks.allgather(gaps))

    def _exchange(self, reached: Reached) -> Reached | None:
        """Send border vertices that this rank has reached to those that have them as well; return what others have."""
        march, row, key, facet = reached
        any_here = len(row) > 0
        received = self._ranks.alltoall([(any_here, columns) for columns in self._addressed(row, march, key, facet)])
        if not any(any_there for any_there, _ in received):
            return None
        row, march, key, facet = map(np.concatenate, zip(*(columns for _, columns in received), strict=True))
        return Reached(march, row, key, facet)

    def _addressed(self, rows: IntArray, *columns: NDArray[Any]) -> list[tuple[NDArray[Any], ...]]:
        """For each other rank the border's vertices ``rows`` that it has too: rows in its border, and ``columns``."""
        there = [self._rows_there[rank][rows] for rank in range(self._ranks.size)]
        return [(row[row >= 0], *(column[row >= 0] for column in columns)) for row in there]


def _whole_boundary(mesh: Mesh, own: MeshPart) -> tuple[IntArray, IntArray, IntArray]:
    """Facets (F, d), markers (F,), vertices across (F,) of the whole mesh, in its numbers."""
    cells, facets = mesh.cells.astype(np.int32), mesh.facets.astype(np.int32)
    across = own.vertices[inner_vertices(facets, cells, *rows_of(cells, len(mesh.points)))]
    sent = own.facets, own.vertices[mesh.facets], mesh.markers, across
    numbers, *columns = map(np.concatenate, zip(*mesh.ranks.allgather(sent), strict=True))
    order = np.argsort(numbers)
    corners, markers, across = (column[order] for column in columns)
    return corners, markers, across


def _rows_in(border: IntArray, wanted: IntArray) -> IntArray:
    """Rows (w,) of the vertices ``wanted`` in an ascending ``border``, or -1."""
    rows = np.minimum(np.searchsorted(border, wanted), max(len(border) - 1, 0))
    return np.where(np.append(border, -1)[rows] == wanted, rows, -1)
