"""What one march writes on: arrays as long as the mesh has vertices, kept from march to march.

A march leaves them as it found them, except for the vertices that it lists in ``touched``; `reset` puts those back.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.types import BoolArray, FloatArray

FAR, TRIAL, KNOWN = np.int8(0), np.int8(1), np.int8(2)
"""States of a vertex: not reached, in the heap, taken out of it."""


class Workspace(NamedTuple):
    """Per vertex: ``state``, ``key`` (squared distance, or distance to first order), ``facet`` nearest so far.

    ``place``, ``heap`` and ``heap_key`` belong to the heap; ``touched`` lists the vertices that are not FAR.
    ``concave`` says of each facet that a march starts from whether one that touches it rises above it into the fluid.
    """

    state: NDArray[np.int8]
    key: FloatArray
    facet: NDArray[np.int32]
    place: NDArray[np.int32]
    heap: NDArray[np.int32]
    heap_key: FloatArray
    touched: NDArray[np.int32]
    concave: BoolArray


def new_workspace(vertices: int, facets: int) -> Workspace:
    """Space for marches over a mesh of so many ``vertices`` and ``facets``."""
    numbers = [np.empty(vertices, np.int32) for _ in range(4)]
    facet, place, heap, touched = numbers
    return Workspace(
        np.zeros(vertices, np.int8),
        np.empty(vertices),
        facet,
        place,
        heap,
        np.empty(vertices),
        touched,
        np.empty(facets, np.bool_),
    )
