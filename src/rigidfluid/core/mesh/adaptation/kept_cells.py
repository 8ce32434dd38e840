"""Cells next to bodies that a new mesh keeps, so that the flow's boundary layers come into it unchanged."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.model.types import Mesh

LAYERS = 2
"""Number of layers of cells that a run keeps: those at a body's vertices, and their neighbours."""

KEPT_QUALITY = 0.5
"""Least quality of a cell that is kept."""

SHORTEST, LONGEST = 0.5, 1.4
"""Edges of a cell that is kept, over the size wanted at their middle."""


def kept_cells(mesh: Mesh, bodies: int, size_at: Callable[[FloatArray], FloatArray], layers: int) -> BoolArray:
    """Tell whether each cell (M,) is in one of the ``layers`` next to a body, well shaped and about as large as wanted.

    ``size_at(points)`` is the wanted size (N,) [length].
    """
    near = np.zeros(len(mesh.points), dtype=bool)
    near[mesh.facets[mesh.markers < bodies]] = True
    kept: BoolArray = np.zeros(len(mesh.cells), dtype=bool)
    for _ in range(layers):
        kept = np.asarray(near[mesh.cells].any(axis=1))
        near[mesh.cells[kept]] = True
    chosen = np.flatnonzero(kept)
    if not len(chosen):
        return kept
    pairs = np.array(list(combinations(range(mesh.cells.shape[1]), 2)))
    ends = mesh.points[mesh.cells[chosen][:, pairs]]
    length, middle = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2), ends.mean(axis=2)
    relative = length / size_at(middle.reshape(-1, middle.shape[2])).reshape(length.shape)
    fits = (relative >= SHORTEST).all(axis=1) & (relative <= LONGEST).all(axis=1)
    kept[chosen] = fits & (cell_quality(mesh.points, mesh.cells[chosen]) >= KEPT_QUALITY)
    return kept
