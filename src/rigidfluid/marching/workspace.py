"""Workspace of one march: arrays as long as the mesh has vertices, kept from march to march.

A march leaves ``state`` as it found it, except for the vertices that it lists as ``visited``; `reset` puts those back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.marching.heap import Heap

FAR, TRIAL, KNOWN, BEYOND = np.int8(0), np.int8(1), np.int8(2), np.int8(3)
"""States of a vertex: not reached, in the heap, reached for good, measured and outside the band."""


class Workspace(NamedTuple):
    """Arrays with a value for each vertex: ``state``, ``key`` (squared distance in exact marches, distance in those of
    first order), and the ``facet`` nearest so far.

    Marches of first order use the ``heap``; ``visited`` lists the vertices touched, those in the band, from its front,
    and those that are BEYOND from its back.
    """

    state: NDArray[np.int8]
    key: FloatArray
    facet: NDArray[np.int32]
    heap: Heap
    visited: NDArray[np.int32]


def new_workspace(vertices: int) -> Workspace:
    """Workspace for marches over a mesh of this number of ``vertices``."""
    facet, visited, entries, place = (np.empty(vertices, np.int32) for _ in range(4))
    heap = Heap(entries, np.empty(vertices), place)
    return Workspace(np.zeros(vertices, np.int8), np.empty(vertices), facet, heap, visited)
