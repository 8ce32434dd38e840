"""A mesh that ranks hold in parts, as one of them sees it: its own cells, and all of the boundary."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.adjacency import inner_vertices, rows_of
from rigidfluid.marching.band import longest_edges
from rigidfluid.marching.field import Band
from rigidfluid.marching.partition import Halted, PlacedPart, Reached, march_side_by_side, part_of
from rigidfluid.marching.topology import Neighbours, Numbers


class Gaps(NamedTuple):
    """Gaps of facets to bodies: the number of the ``pair`` (c,) of surfaces, the ``facet`` (c,), the ``gap`` (c,)
    [length] and the facet ``partner`` (c,) of the body that it is to."""

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
    """One rank's part of a mesh with the whole boundary; made and used by all ranks together.

    Facets have their numbers in the whole mesh; no cell of another rank is known.
    """

    def __init__(self, mesh: Mesh) -> None:
        assert mesh.part is not None
        self.mesh, self._ranks, place = mesh, mesh.ranks, mesh.part
        facets, markers, across = self._boundary(mesh)
        shared = np.concatenate(self._ranks.allgather(place.vertices[~place.owned]))
        self.part = part_of(place.vertices[mesh.cells], facets, markers, across, shared)
        self._own_facets = np.zeros(len(facets), dtype=bool)
        self._own_facets[place.facets] = True
        self._posted = np.flatnonzero(place.owned & np.isin(place.vertices, np.append(facets, across)))
        posted = np.concatenate(self._ranks.allgather(place.vertices[self._posted]))
        order = np.argsort(self.part.vertices)
        self._post = order[np.searchsorted(self.part.vertices, posted, sorter=order)]
        border = place.vertices[self.part.border]
        self._rows_there = [_rows_in(theirs, border) for theirs in self._ranks.allgather(border)]
        self._rows_there[self._ranks.rank][:] = -1
        self.exchanges = 0

    def facets_of(self, surface: int) -> Numbers:
        """Facets of a surface that are in this rank's part."""
        facets = self.part.topology.facets_of(surface)
        return facets[self._own_facets[facets]]

    def points(self, mesh: Mesh) -> FloatArray:
        """Present coordinates of the vertices of the part and of the boundary, (n, d) [length]."""
        points = np.empty((len(self.part.vertices), mesh.points.shape[1]))
        points[: len(mesh.points)] = mesh.points
        points[self._post] = np.concatenate(self._ranks.allgather(mesh.points[self._posted]))
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

    def _boundary(self, mesh: Mesh) -> tuple[IntArray, IntArray, IntArray]:
        """Facets (F, d), markers (F,), vertices across (F,) of the whole mesh."""
        assert mesh.part is not None
        cells, facets = mesh.cells.astype(np.int32), mesh.facets.astype(np.int32)
        vertices, across = mesh.part.vertices, inner_vertices(facets, cells, *rows_of(cells, len(mesh.points)))
        sent = mesh.part.facets, vertices[mesh.facets], mesh.markers, vertices[across]
        numbers, corners, markers, seen_from = map(np.concatenate, zip(*self._ranks.allgather(sent), strict=True))
        order = np.argsort(numbers)
        return corners[order], markers[order], seen_from[order]

    def _exchange(self, reached: Reached) -> Reached | None:
        """Send border vertices that ranks have reached to those that have them on their border as well."""
        march, row, key, facet = reached
        news = len(row) > 0
        everyones = self._ranks.alltoall([(news, piece) for piece in self._addressed(row, march, key, facet)])
        self.exchanges += 1
        if not any(new for new, _ in everyones):
            return None
        row, march, key, facet = map(np.concatenate, zip(*(piece for _, piece in everyones), strict=True))
        return Reached(march, row, key, facet)

    def _addressed(self, rows: IntArray, *columns: NDArray[Any]) -> list[tuple[NDArray[Any], ...]]:
        """Rows in each other rank's border of the vertices ``rows`` that it has as well, with their ``columns``."""
        there = [self._rows_there[rank][rows] for rank in range(self._ranks.size)]
        return [(row[row >= 0], *(column[row >= 0] for column in columns)) for row in there]


def _rows_in(border: IntArray, wanted: IntArray) -> IntArray:
    """Places (w,) of the vertices ``wanted`` on an ascending ``border``, or -1."""
    rows = np.minimum(np.searchsorted(border, wanted), max(len(border) - 1, 0))
    return np.where(np.append(border, -1)[rows] == wanted, rows, -1)
