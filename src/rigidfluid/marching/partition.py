"""One distance field over a mesh in parts, each with its own workspace: for threads here, for ranks in `shared`.

Each part holds its own cells, and all facets of the boundary, which are few. Vertices on the border of two parts are in
both. A part marches as far as it can, then the parts exchange how far they came on their borders and march on from
there, until nothing is new. As a vertex gets its distance at its first visit, wherever that comes from, the field is
that of the whole mesh.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Barrier, BrokenBarrierError, Lock

import numpy as np

from rigidfluid.core.model.types import FloatArray, IntArray, Mesh
from rigidfluid.marching.exact import accept, march, reset, seed
from rigidfluid.marching.field import DistanceField, Wave
from rigidfluid.marching.topology import Neighbours, Numbers, Topology
from rigidfluid.marching.workspace import KNOWN, Workspace, new_workspace

NOT_REACHED = np.int32(-1)
"""In place of a facet, where a part has not come to a vertex of its border."""

Exchange = Callable[[FloatArray, Numbers], tuple[FloatArray, Numbers] | None]
"""From squared distance and facet at a part's border to those of any part that has come there; None if none is new."""


@dataclass(frozen=True, slots=True)
class Part:
    """Some cells of a mesh: ``topology`` in numbers of its own, ``vertices`` (n,) their numbers in the whole mesh.

    ``border`` (s,) are its own numbers of vertices that other parts hold as well.
    """

    topology: Topology
    vertices: IntArray
    border: Numbers
    workspace: Workspace


def split(mesh: Mesh, owner: IntArray) -> list[Part]:
    """Cut a mesh into parts along its facets.

    Parameters
    ----------
    mesh : Mesh
        The whole.
    owner : (M,) array
        Number of the part that each cell goes to, from 0.

    Returns
    -------
    list of Part
        In the order of their numbers.
    """
    groups = [mesh.cells[owner == number] for number in range(int(owner.max()) + 1)]
    holders = np.zeros(len(mesh.points), dtype=np.int64)
    for cells in groups:
        holders[np.unique(cells)] += 1
    boundary = mesh.facets, mesh.markers, Topology.of(mesh).surfaces.across.astype(np.int64)
    return [part_of(cells, *boundary, np.flatnonzero(holders > 1)) for cells in groups]


def part_of(cells: IntArray, facets: IntArray, markers: IntArray, across: IntArray, shared: IntArray) -> Part:
    """A part with some cells and the whole boundary; all is given in numbers of the whole mesh.

    Parameters
    ----------
    cells : (M, d+1) array
        The part's own.
    facets : (F, d) array
        All of the boundary.
    markers : (F,) array
        Their surfaces.
    across : (F,) array
        The vertex of each facet's cell that is not on the facet.
    shared : (s,) array
        Vertices that several parts have; those of other parts may be among them.

    Returns
    -------
    Part
        The vertices of its cells first, in ascending order. A vertex of the boundary that is in no cell of the part is
        just a point.
    """
    inside = np.unique(cells)
    vertices = np.concatenate([inside, np.setdiff1d(np.append(facets, across), inside)])
    order = np.argsort(vertices)

    def own(numbers: IntArray) -> IntArray:
        return order[np.searchsorted(vertices, numbers, sorter=order)]

    topology = Topology(own(cells), own(facets), markers, len(vertices), own(across).astype(np.int32))
    border = np.flatnonzero(np.isin(inside, shared)).astype(np.int32)
    return Part(topology, vertices, border, new_workspace(len(vertices)))


def march_part(
    part: Part, points: FloatArray, surfaces: Iterable[int], band_width: float, exchange: Exchange
) -> DistanceField:
    """This part of the distance field of the whole mesh, D(x) = min |x - y| over the facets y of some surfaces.

    Parameters
    ----------
    part : Part
        From `split`.
    points : (n, d) array
        The part's own vertices, in the order of ``part.vertices`` [length].
    surfaces : iterable of int
        Markers of the surfaces to measure from.
    band_width : float
        Where the march stops [length].
    exchange : callable
        Called by all parts together, as often as needed.

    Returns
    -------
    DistanceField
        In the numbers of the whole mesh, for the vertices of this part.

    Notes
    -----
    Only exact: `march_first_order` fixes each vertex once, in the order of the whole mesh, and on obtuse cells its
    values depend on that order.
    """
    work = part.workspace
    wave = march_part_from(part, points, part.topology.neighbours, surfaces, band_width, 0.0, work, exchange)
    local = work.touched[: wave.touched].copy()
    field = DistanceField(part.vertices[local].astype(np.int32), np.sqrt(work.key[local]), work.facet[local])
    reset(work, wave.touched, wave.beyond)
    return field


def march_part_from(
    part: Part,
    points: FloatArray,
    neighbours: Neighbours,
    surfaces: Iterable[int],
    band_width: float,
    slack: float,
    work: Workspace,
    exchange: Exchange,
) -> Wave:
    """March and leave the field in ``work``, as `march_from` does with the whole mesh.

    With ``slack`` the ``neighbours`` must know the longest edges elsewhere, at the vertices of the border.
    """
    topology = part.topology
    seeds = topology.seeds(surfaces)
    touched, tree = seed(points, topology.surfaces, seeds.facets, seeds.whole, work)
    surface, band = (topology.surfaces, seeds.wanted, tree), (band_width, slack)
    first = beyond = 0
    while True:
        counts = first, touched, beyond
        touched, beyond = march(points, neighbours, *surface, *band, work, *counts)
        reached = work.state[part.border] == KNOWN
        found = exchange(work.key[part.border], np.where(reached, work.facet[part.border], NOT_REACHED))
        if found is None:
            return Wave(touched, beyond, tree)
        first, touched = touched, accept(part.border, *found, work, touched)


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
    """Where parts in one process leave what they know of their borders; all wait for all before they read."""

    def __init__(self, parts: Sequence[Part], count: int) -> None:
        self._key, self._facet = np.zeros(count), np.full(count, NOT_REACHED)
        self._lock, self._barrier = Lock(), Barrier(len(parts))
        self._new = False

    def exchange_of(self, part: Part) -> Exchange:
        """The callback of one part."""
        border = part.vertices[part.border]

        def exchange(key: FloatArray, facet: Numbers) -> tuple[FloatArray, Numbers] | None:
            self._barrier.wait()
            self._new = False
            self._barrier.wait()
            with self._lock:
                self._post(border, key, facet)
            self._barrier.wait()
            return (self._key[border], self._facet[border]) if self._new else None

        return exchange

    def give_up(self) -> None:
        """Let nobody wait for a part that has failed."""
        self._barrier.abort()

    def _post(self, border: IntArray, key: FloatArray, facet: Numbers) -> None:
        known = self._facet[border]
        self._new |= bool(np.any((known < 0) & (facet >= 0)))
        # of equally near facets the last, whoever comes first
        better = facet > known
        self._key[border[better]], self._facet[border[better]] = key[better], facet[better]
