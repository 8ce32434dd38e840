"""A mesh that ranks hold in parts, as one of them sees it: its own cells, and all of the boundary."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Mesh
from rigidfluid.marching.adjacency import inner_vertices, rows_of
from rigidfluid.marching.band import longest_edges
from rigidfluid.marching.field import Wave
from rigidfluid.marching.partition import NOT_REACHED, Exchange, march_part_from, part_of
from rigidfluid.marching.topology import Neighbours, Numbers
from rigidfluid.marching.workspace import Workspace


class Gaps(NamedTuple):
    """Of facets of the surface ``other``, the ``gap`` (c,) to ``body`` and the facet ``partner`` (c,) that it is to."""

    body: int
    other: int
    facet: Numbers
    gap: FloatArray
    partner: Numbers


class SharedMesh:
    """One rank's part of a mesh with the whole boundary; made and used by all ranks together.

    Facets have their numbers in the whole mesh; no cell of another rank is known.

    Parameters
    ----------
    mesh : Mesh
        The rank's part.
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
        self._post, _ = _found(self.part.vertices, posted)
        self._border = place.vertices[self.part.border]
        self._met, self._meets = _found(self._border, np.concatenate(self._ranks.allgather(self._border)))
        self.exchanges = 0

    def facets_of(self, surface: int) -> Numbers:
        """Facets of a surface that are in this rank's part."""
        facets = self.part.topology.facets_of(surface)
        return facets[self._own_facets[facets]]

    def points(self, mesh: Mesh) -> FloatArray:
        """Where the vertices of the part and of the boundary are now, (n, d) [length]."""
        points = np.empty((len(self.part.vertices), mesh.points.shape[1]))
        points[: len(mesh.points)] = mesh.points
        points[self._post] = np.concatenate(self._ranks.allgather(mesh.points[self._posted]))
        return points

    def neighbours(self, points: FloatArray) -> Neighbours:
        """The part's, with the longest edges elsewhere, when its vertices are at ``points`` (n, d)."""
        own, border = self.part.topology.neighbours, self.part.border
        squares = np.concatenate(self._ranks.allgather(longest_edges(points, own, border)))
        elsewhere = np.zeros(len(points))
        np.maximum.at(elsewhere, border[self._met], squares[self._meets])
        return own._replace(elsewhere=elsewhere)

    def march(
        self,
        points: FloatArray,
        neighbours: Neighbours,
        surfaces: Iterable[int],
        width: float,
        slack: float,
        work: Workspace,
    ) -> Wave:
        """Leave this part of the field in ``work``, as `march_from` does that of a whole mesh."""
        return march_part_from(self.part, points, neighbours, surfaces, width, slack, work, self._exchange())

    def together(self, gaps: Sequence[Gaps]) -> list[Gaps]:
        """Pair by pair the finite gaps that all ranks have found, facets ascending."""
        found = [np.isfinite(one.gap) for one in gaps]
        sent = [(one.facet[near], one.gap[near], one.partner[near]) for one, near in zip(gaps, found, strict=True)]
        everyone = [
            [np.concatenate(column) for column in zip(*pieces, strict=True)]
            for pieces in zip(*self._ranks.allgather(sent), strict=True)
        ]
        orders = [np.argsort(facet) for facet, _, _ in everyone]
        return [
            Gaps(one.body, one.other, *(column[order] for column in columns))
            for one, columns, order in zip(gaps, everyone, orders, strict=True)
        ]

    def _boundary(self, mesh: Mesh) -> tuple[IntArray, IntArray, IntArray]:
        """Facets (F, d), markers (F,), vertices across (F,) of the whole mesh."""
        assert mesh.part is not None
        cells, facets = mesh.cells.astype(np.int32), mesh.facets.astype(np.int32)
        vertices, across = mesh.part.vertices, inner_vertices(facets, cells, *rows_of(cells, len(mesh.points)))
        sent = mesh.part.facets, vertices[mesh.facets], mesh.markers, vertices[across]
        numbers, corners, markers, seen_from = map(np.concatenate, zip(*self._ranks.allgather(sent), strict=True))
        order = np.argsort(numbers)
        return corners[order], markers[order], seen_from[order]

    def _exchange(self) -> Exchange:
        """For one march: the ranks tell each other what they have reached since the last time."""
        key, facet = np.zeros(len(self._border)), np.full(len(self._border), NOT_REACHED)

        def exchange(own_key: FloatArray, own_facet: Numbers) -> tuple[FloatArray, Numbers] | None:
            new = (own_facet >= 0) & (facet < 0)
            pieces = self._ranks.allgather((self._border[new], own_key[new], own_facet[new]))
            self.exchanges += 1
            vertices, keys, facets = map(np.concatenate, zip(*pieces, strict=True))
            rows, mine = _found(self._border, vertices)
            keys, facets = keys[mine], facets[mine]
            # of equally near facets the last, whoever comes first
            last = np.argsort(facets, kind="stable")
            key[rows[last]], facet[rows[last]] = keys[last], facets[last]
            return (key, facet) if len(vertices) else None

        return exchange


def _found(numbers: IntArray, wanted: IntArray) -> tuple[IntArray, BoolArray]:
    """Where those ``wanted`` stand among ``numbers``, (f,), and which of them do, (w,)."""
    held, order = np.isin(wanted, numbers), np.argsort(numbers)
    return order[np.searchsorted(numbers, wanted[held], sorter=order)], held
