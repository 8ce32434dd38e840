"""Shifts of cells by which a periodic mesh is cut open: changed so that its seams for two directions have no facet in
common, and are smooth."""

from __future__ import annotations

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import BoolArray, IntArray
from rigidfluid.core.mesh.adaptation.recut import Neighbours
from rigidfluid.core.mesh.topology import REMEDY
from rigidfluid.errors import MeshError

_SWEEPS = 20
"""Largest number of times that all cells at a seam are looked at."""


def smooth_cut(shift: IntArray, pairs: Neighbours, held: BoolArray, bad: BoolArray) -> IntArray:
    """The ``shift`` (M, k) of cells, changed for those that are not ``held`` (M,), so that no neighbours are apart in
    two directions, and no cell would have fewer facets on the seam with another shift.

    One direction comes after the other. Cells between which one seam already runs have one shift in the next direction.
    ``bad`` cells (M,) have none of their facets on the seam if that can be, as re-meshing could not change those.
    Raises MeshError where the cells that are held want different ones.
    """
    whole = np.asarray((bad & ~held)[pairs.cells].any(axis=1))
    try:
        found, conflicts = find_cut(shift, pairs, held, whole)
    except MeshError:
        conflicts = np.flatnonzero(held)
    if len(conflicts):
        found, conflicts = find_cut(shift, pairs, held)
    if len(conflicts):
        raise MeshError("mesh", "bodies too near for a seam between them", "a cell between bodies", REMEDY)
    return found


def find_cut(
    shift: IntArray, pairs: Neighbours, held: BoolArray, together: BoolArray | None = None
) -> tuple[IntArray, IntArray]:
    """The shift of `smooth_cut` (M, k), one for neighbours that stay ``together`` (P,); or the cells (C,) that are held
    and want different ones."""
    found = shift.copy()
    apart = np.zeros(len(pairs.cells), dtype=bool) if together is None else together
    for axis in range(shift.shape[1]):
        groups = _Groups(pairs, apart, axis, len(shift))
        conflicts = groups.conflicts(shift[:, axis], held)
        if len(conflicts):
            return found, conflicts
        found[:, axis] = groups.smoothed(shift[:, axis], held)
        one, other = found[pairs.cells.T, axis]
        apart = apart | (pairs.apart[:, axis] + one != other)
    return found, np.zeros(0, dtype=np.int64)


class _Groups:
    """Groups of cells that are ``together`` (P,) with neighbours: they have one shift along an ``axis``, but for their
    places in the mesh."""

    def __init__(self, pairs: Neighbours, together: BoolArray, axis: int, cells: int) -> None:
        one, other = pairs.cells.T
        apart = pairs.apart[:, axis]
        graph = scipy.sparse.csr_array(
            (np.ones(together.sum()), (one[together], other[together])), shape=(cells, cells)
        )
        self._count, self._group = scipy.sparse.csgraph.connected_components(graph, directed=False)
        self._place = self._places(one[together], other[together], apart[together])
        rest = ~together & (self._group[one] != self._group[other])
        one, other, apart = one[rest], other[rest], apart[rest] + self._place[one[rest]] - self._place[other[rest]]
        self._owner = self._group[np.concatenate([one, other])]
        self._next = self._group[np.concatenate([other, one])]
        self._jump = np.concatenate([-apart, apart])

    def _places(self, one: IntArray, other: IntArray, apart: IntArray) -> IntArray:
        """Shift of each cell (M,) less that of its group, from those ``apart`` of neighbours."""
        first = np.unique(self._group, return_index=True)[1]
        known, place = np.zeros((2, len(self._group)), dtype=np.int64)
        known[first] = 1
        while not known.all():
            for start, end, step in ((one, other, apart), (other, one, -apart)):
                fresh = (known[start] == 1) & (known[end] == 0)
                place[end[fresh]] = place[start[fresh]] + step[fresh]
                known[end[fresh]] = 1
        if (place[one] + apart != place[other]).any():
            raise MeshError("mesh", "a seam that meets itself", "seams that cross each other once", REMEDY)
        return place

    def conflicts(self, shift: IntArray, held: BoolArray) -> IntArray:
        """Cells (C,) that are ``held`` (M,) in groups of which these want different shifts."""
        cells = np.flatnonzero(held)
        group, base = self._group[cells], (shift - self._place)[cells]
        first = np.zeros(self._count, dtype=np.int64)
        first[group] = base
        bad = np.zeros(self._count, dtype=bool)
        bad[group[first[group] != base]] = True
        return np.asarray(cells[bad[group]])

    def smoothed(self, shift: IntArray, held: BoolArray) -> IntArray:
        """Shifts (M,) near ``shift`` (M,), the same of cells that are ``held`` (M,), with short seams."""
        base, group, fixed = shift - self._place, self._group, np.zeros(self._count, dtype=bool)
        found = np.rint(np.bincount(group, base) / np.bincount(group)).astype(np.int64)
        found[group[held]] = base[held]
        fixed[group[held]] = True
        order = np.argsort(self._owner, kind="stable")
        start = np.searchsorted(self._owner[order], np.arange(self._count + 1))
        for _ in range(_SWEEPS):
            before = found.copy()
            cut = np.unique(self._owner[found[self._next] + self._jump != found[self._owner]])
            for here in cut[~fixed[cut]].tolist():
                around = order[start[here] : start[here + 1]]
                wanted = found[self._next[around]] + self._jump[around]
                choices = np.append(found[here], wanted)
                found[here] = choices[np.argmin(np.abs(choices[:, None] - wanted).sum(axis=1))]
            if np.array_equal(found, before):
                break
        return np.asarray(found[group] + self._place)
