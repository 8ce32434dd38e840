"""Shares independent marches out to threads; the compiled kernels let them run side by side."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from typing import TypeVar

from rigidfluid.core.model.types import Mesh
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import Workspace, new_workspace

Item = TypeVar("Item")
Result = TypeVar("Result")

FEWEST = 4
"""Number of marches for which a further thread is worth its start."""


class Workers:
    """The topology of the latest mesh, and a workspace for each thread; regenerated only when the cells change.

    0 ``threads`` are as many as there are cores for this process.
    """

    def __init__(self, threads: int) -> None:
        self._threads = threads or _cores()
        self._mesh = Mesh.empty(2)
        self._workspaces: list[Workspace] = []

    def topology(self, mesh: Mesh) -> Topology:
        """The topology of ``mesh``; kept while its cells, facets and markers are the same arrays."""
        if not same_topology(mesh, self._mesh):
            self._mesh, self._topology = mesh, Topology.from_mesh(mesh)
            self._workspaces.clear()
        return self._topology

    def map(self, work: Callable[[Workspace, Item], Sequence[Result]], items: Sequence[Item]) -> list[Result]:
        """All results of ``work`` for all items, in no particular order."""
        count = max(1, min(self._threads, len(items) // FEWEST))
        while len(self._workspaces) < count:
            self._workspaces.append(new_workspace(self._topology.vertices))

        def share(number: int) -> list[Result]:
            space = self._workspaces[number]
            return [result for item in items[number::count] for result in work(space, item)]

        if count == 1:
            return share(0)
        with ThreadPoolExecutor(count) as pool:
            return list(chain.from_iterable(pool.map(share, range(count))))


def same_topology(one: Mesh, other: Mesh) -> bool:
    """Tell whether two meshes differ by where their vertices are alone, as told by the arrays that they share."""
    return one.cells is other.cells and one.facets is other.facets and one.markers is other.markers


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
