"""Cells as fine as an accuracy demands: each is to have the same part of the error."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.flow import Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.mesh_error import EstimatedError
from rigidfluid.core.model.part import PartOptions

_ORDER = 2.0
"""Order of the error in the edge length."""

_AIM = 0.8
"""Error aimed at over the one allowed, so that a mesh lasts while the flow changes."""

_MOST = 2.0
"""Greatest change of an edge's length from mesh to mesh, up and down: residuals of coarse cells tell no more."""

_WORTH = 1.25
"""Ratio of errors, or of numbers of cells, from which another mesh is worth it."""


SETTLED, LASTING = 4.0, 20.0
"""Whole steps on a mesh before another is made for a smaller error, and for fewer cells: a transferred flow errs more
at first, and not all cells may become larger."""


class Equidistribution(SizeField):
    r"""Size field of `mesh.accuracy`: cells of equal errors, as few as have the relative error ``accuracy`` [1]
    together, and about ``most_cells`` at most.

    With errors η_K² ∝ h^(2p+d) of cells, p = 2, the fewest cells of a given sum Σ η_K² have the same error t each:

    h = h_K (t/η_K²)^(1/(2p+d)), t = (target/S)^((2p+d)/2p), S = Σ (η_K²)^(d/(2p+d))

    No edge changes by more than a factor of two from mesh to mesh. Nothing is asked for where no error is known.

    Notes
    -----
    P. Ladevèze, G. Coffignal and J. P. Pelle, in I. Babuška et al. (eds.), Accuracy Estimates and Adaptive Refinements
    in Finite Element Computations, Wiley 1986.
    """

    name = "accuracy"

    def __init__(self, accuracy: float, most_cells: int, dimension: int) -> None:
        super().__init__(PartOptions(), dimension)
        self.accuracy, self.most_cells = accuracy, most_cells

    def edge_length(self, points: FloatArray, around: FluidDomain, flow: Flow) -> FloatArray:
        """h, (m,) [length]."""
        longest, error = np.full(len(points), around.width), flow.error
        if error is None or not 0.0 < error.relative < np.inf:
            return longest
        wanted = np.log(flow.cell_edges * self._changes(error))
        return np.asarray(np.minimum(np.exp(flow.from_cells(wanted, points)), longest))

    def is_due(self, error: EstimatedError, age: float, room: FloatArray | float = np.inf) -> bool:
        """Tell whether a mesh of so many whole steps' ``age`` is worth another, whose ``error`` or number of cells is so
        much smaller; edges of cells may grow by the factors ``room`` (M,) [1] at most."""
        misses = error.relative > self.accuracy
        if age < (SETTLED if misses else LASTING) or not 0.0 < error.relative < np.inf:
            return False
        changes = np.minimum(self._changes(error), room)
        if misses:
            return _WORTH**2 * float(error.cells @ changes ** (2.0 * _ORDER)) < error.total
        return _WORTH * float(np.sum(changes**-self.dimension)) < len(changes)

    def _changes(self, error: EstimatedError) -> FloatArray:
        """Wanted over present edge length of each cell (M,) [1]."""
        d, order = self.dimension, 2.0 * _ORDER + self.dimension
        relative = np.maximum(error.cells / error.total, np.finfo(float).tiny)
        weight = float(np.sum(relative ** (d / order)))
        target = (_AIM * self.accuracy / error.relative) ** 2
        each = max((target / weight) ** (order / (2.0 * _ORDER)), (weight / self.most_cells) ** (order / d))
        return np.asarray(np.clip((each / relative) ** (1.0 / order), 1.0 / _MOST, _MOST))
