"""Distance fields over a mesh in parts, each with its own workspace: for threads here, for ranks in `shared`.

Each part holds its own cells, and all facets of the boundary, which are few. Vertices on the border of two parts are in
both. A part marches as far as it can, then the parts exchange how far they came on their borders and march on from
there, until nothing is new. A vertex gets its distance at its first visit, wherever that comes from, so that the field
is that of the whole mesh. Several fields take their turns on one workspace, so that an exchange serves all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from threading import Barrier, BrokenBarrierError, Lock
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.exact import Front, accept, march, put_aside, put_back, seed
from rigidfluid.marching.field import Band, DistanceField
from rigidfluid.marching.topology import Neighbours, Numbers, Target, Topology
from rigidfluid.marching.workspace import Workspace, new_workspace

NOT_REACHED = np.int32(-1)
"""Number in place of a facet, at a vertex of a border that no part has come to."""


class Reached(NamedTuple):
    """Vertices of a part's border that marches have come to, in any order.

    ``march`` (c,) is the number of the march, ``row`` (c,) the vertex' place in the border, ``key`` (c,) the squared
    distance [length²], ``facet`` (c,) the nearest.
    """

    march: IntArray
    row: IntArray
    key: FloatArray
    facet: Numbers

    def select(self, chosen: IntArray) -> Reached:
        """The ``chosen`` vertices."""
        return Reached(self.march[chosen], self.row[chosen], self.key[chosen], self.facet[chosen])


Exchange = Callable[[Reached], Reached | None]
"""Exchange of border vertices reached since the last one: a part's own for the others'; None if no part has any."""


class Halted(NamedTuple):
    """A march that has left its workspace to others: ``vertices`` in the band with their ``key`` and ``facet``, those
    ``beyond`` it, and its ``target``."""

    vertices: Numbers
    key: FloatArray
    facet: Numbers
    beyond: Numbers
    target: Target


@dataclass(frozen=True, slots=True)
class Part:
    """Some cells of a mesh: ``topology`` in numbers of its own, ``vertices`` (n,) their numbers in the whole mesh.

    The first ``inside`` vertices are those of its cells. ``border`` (s,) are its own numbers of vertices that other
    parts hold as well, ``border_row`` (n,) the place of each vertex there, or -1.
    """

    topology: Topology
    vertices: IntArray
    inside: int
    border: Numbers
    border_row: Numbers
    workspace: Workspace


class PlacedPart(NamedTuple):
    """A ``part`` where it lies: its vertices in their order are at ``points`` (n, d) [length].

    Its ``neighbours`` know the longest edges elsewhere, at the border, where a band has a slack.
    """

    part: Part
    points: FloatArray
    neighbours: Neighbours


def split(mesh: Mesh, owner: IntArray) -> list[Part]:
    """Cut a whole mesh into parts along its facets; ``owner`` (M,) is the number of each cell's part, from 0."""
    groups = [mesh.cells[owner == number] for number in range(int(owner.max()) + 1)]
    holders = np.zeros(len(mesh.points), dtype=np.int64)
    for cells in groups:
        holders[np.unique(cells)] += 1
    boundary = mesh.facets, mesh.markers, Topology.from_mesh(mesh).surfaces.across.astype(np.int64)
    return [part_of(cells, *boundary, np.flatnonzero(holders > 1)) for cells in groups]


def part_of(cells: IntArray, facets: IntArray, markers: IntArray, across: IntArray, shared: IntArray) -> Part:
    """Part with ``cells`` (M, d+1) and all boundary ``facets`` (F, d), given in numbers of the whole mesh.

    ``across`` (F,) are the vertices of the facets' cells off the facets, ``shared`` (s,) all that several parts have.
    The vertices of the part's cells come first, ascending; a boundary vertex in none of its cells is just a point.
    """
    inside = np.unique(cells)
    vertices = np.concatenate([inside, np.setdiff1d(np.append(facets, across), inside)])
    order = np.argsort(vertices)

    def own(numbers: IntArray) -> IntArray:
        return order[np.searchsorted(vertices, numbers, sorter=order)]

    topology = Topology(own(cells), own(facets), markers, len(vertices), own(across).astype(np.int32))
    border = np.flatnonzero(np.isin(inside, shared)).astype(np.int32)
    border_row = np.full(len(vertices), -1, np.int32)
    border_row[border] = np.arange(len(border))
    return Part(topology, vertices, len(inside), border, border_row, new_workspace(len(vertices)))


def march_part(
    part: Part, points: FloatArray, surfaces: Iterable[int], band_width: float, exchange: Exchange
) -> DistanceField:
    """This part of the distance field of the whole mesh, D(x) = min |x - y| over the facets y of some surfaces.

    ``points`` (n, d) are in the order of ``part.vertices`` [length], and the field is in numbers of the whole mesh. All
    parts call ``exchange`` together, as often as needed.

    Notes
    -----
    Only exact: `march_first_order` fixes each vertex once, in the order of the whole mesh, and on obtuse cells its
    values depend on that order.
    """
    chosen = [tuple(surfaces)]
    placed = PlacedPart(part, points, part.topology.adjacency.neighbours)
    [march] = march_side_by_side(placed, chosen, Band(band_width), exchange)
    if march is None:
        return DistanceField(np.empty(0, np.int32), np.empty(0), np.empty(0, np.int32))
    return DistanceField(part.vertices[march.vertices].astype(np.int32), np.sqrt(march.key), march.facet)


def march_side_by_side(
    placed: PlacedPart, sources: Sequence[Sequence[int]], band: Band, exchange: Exchange
) -> list[Halted | None]:
    """This part of several fields of the whole mesh, each from its own ``sources``; None if a field does not reach it.

    All parts call ``exchange`` together, once a round for all fields.
    """
    marches: list[Halted | None] = [None] * len(sources)
    due = [(number, _NOTHING) for number, surfaces in enumerate(sources) if _starts_in(placed.part, surfaces)]
    while True:
        fresh = [_NOTHING]
        for number, news in due:
            march, rows, first = _go_on(placed, sources[number], band, marches[number], news)
            marches[number] = march
            fresh.append(Reached(np.full(len(rows), number), rows, march.key[first], march.facet[first]))
        found = exchange(Reached(*map(np.concatenate, zip(*fresh, strict=True))))
        if found is None:
            return marches
        due = _news_of_marches(found)


_NOTHING = Reached(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0), np.empty(0, np.int32))


def _starts_in(part: Part, surfaces: Sequence[int]) -> bool:
    """Tell whether a vertex of the surfaces is in the part's cells; else a march from them has nowhere to go."""
    corners = part.topology.surfaces.facets[part.topology.seeds(surfaces).facets]
    return bool((corners < part.inside).any())


def _go_on(
    placed: PlacedPart, surfaces: Sequence[int], band: Band, before: Halted | None, news: Reached
) -> tuple[Halted, IntArray, IntArray]:
    """March on from ``news``; return also the border rows newly reached and their places among the march's vertices."""
    part, points, neighbours = placed
    work = part.workspace
    if before is None:
        size, target = seed(points, part.topology.surfaces, part.topology.seeds(surfaces), work)
        first = beyond = 0
    else:
        put_back(work, *before[:4])
        first = size = len(before.vertices)
        target, beyond = before.target, len(before.beyond)
    taken = accept(part.border[news.row], news.key, news.facet, work, size)
    touched, beyond = march(neighbours, target, band, work, Front(first, taken, beyond))
    vertices, key, facet, outside = put_aside(work, touched, beyond)
    rows = part.border_row[vertices[taken:]]
    at_border = np.flatnonzero(rows >= 0)
    return Halted(vertices, key, facet, outside, target), rows[at_border].astype(np.int64), taken + at_border


def _news_of_marches(found: Reached) -> list[tuple[int, Reached]]:
    """Group news by the number of their march, along the border; of equally near facets the last is first."""
    order = np.lexsort((-found.facet, found.row, found.march))
    numbers, starts = np.unique(found.march[order], return_index=True)
    pieces = [order[first:end] for first, end in pairwise((*starts, len(order)))]
    return [(int(number), found.select(piece)) for number, piece in zip(numbers, pieces, strict=True)]


def field_in_threads(
    parts: Sequence[Part], points: FloatArray, surfaces: Iterable[int], band_width: float = np.inf
) -> DistanceField:
    """The field of `distance_field`, one thread for each part; on borders and surfaces vertices come once per part."""
    chosen = list(surfaces)
    board = _Board(parts, len(points))
    with ThreadPoolExecutor(len(parts)) as pool:
        jobs = [pool.submit(_march_or_give_up, part, points, chosen, band_width, board) for part in parts]
    failures = [failure for job in jobs if (failure := job.exception()) is not None]
    if failures:
        # those who waited for the part that failed have broken barriers only
        raise min(failures, key=lambda failure: isinstance(failure, BrokenBarrierError))
    fields = [job.result() for job in jobs]
    columns = ([getattr(field, name) for field in fields] for name in DistanceField.__slots__)
    return DistanceField(*map(np.concatenate, columns))


def _march_or_give_up(
    part: Part, points: FloatArray, surfaces: Iterable[int], band_width: float, board: _Board
) -> DistanceField:
    try:
        return march_part(part, points[part.vertices], surfaces, band_width, board.exchange_of(part))
    except BaseException:
        board.give_up()
        raise


class _Board:
    """Notice board on which parts in one process post their borders; all wait for all before they read."""

    def __init__(self, parts: Sequence[Part], count: int) -> None:
        self._key, self._facet = np.zeros(count), np.full(count, NOT_REACHED)
        self._lock, self._barrier = Lock(), Barrier(len(parts))
        self._new = False

    def exchange_of(self, part: Part) -> Exchange:
        """Callback by which one part exchanges its border."""
        border = part.vertices[part.border]

        def exchange(reached: Reached) -> Reached | None:
            self._barrier.wait()
            self._new = False
            self._barrier.wait()
            with self._lock:
                self._post(border[reached.row], reached.key, reached.facet)
            self._barrier.wait()
            if not self._new:
                return None
            rows = np.flatnonzero(self._facet[border] != NOT_REACHED)
            return Reached(np.zeros_like(rows), rows, self._key[border[rows]], self._facet[border[rows]])

        return exchange

    def give_up(self) -> None:
        """Let nobody wait for a part that has failed."""
        self._barrier.abort()

    def _post(self, vertices: IntArray, key: FloatArray, facet: Numbers) -> None:
        self._new |= len(vertices) > 0
        # of equally near facets the last, whoever comes first
        better = facet > self._facet[vertices]
        self._key[vertices[better]], self._facet[vertices[better]] = key[better], facet[better]
