"""Cells as fine as an accuracy demands: each is to have the same part of the error."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.flow import Flow
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.size_field import LONGEST
from rigidfluid.core.mesh.size.size_interface import SizeField
from rigidfluid.core.model.mesh_error import EstimatedError
from rigidfluid.core.model.part import PartOptions

_ORDER = 2.0
"""Half of the order in the edge length of what cells add up to: of the error of velocity gradients and pressure."""

_AIM = 0.7
"""Error aimed at over the one allowed, of a force the root of that: the mesher leaves edges that are too long, and a
mesh is to last while the flow changes."""

_MOST = 2.0
"""Greatest change of an edge's length from mesh to mesh, up and down: residuals of coarse cells tell no more."""

_WORTH, _WORTH_SOON = 1.25, 2.0
"""Ratio of errors, of a force of their roots, or of numbers of cells, from which another mesh is worth it; and of
errors while a mesh is new."""

_SETTLED, _LASTING = 4.0, 20.0
"""Whole steps before a mesh is replaced, as a transferred flow errs more at first, and while it is new: what the mesher
has not done it does not do a few steps later."""

_COLLAPSED = np.sqrt(2.0)
"""Wanted over present length from which the mesher makes an edge longer."""

_ON_BODIES = 0.1
"""Greatest distance from a body, over the wanted edge, of points on it: edges are chords of round bodies."""


class Equidistribution(SizeField):
    r"""Size field of `mesh.accuracy`: cells with equal parts of the error, as few as have the relative error
    ``accuracy`` [1] together, and about ``most_cells`` at most.

    With parts η_K² ∝ h^(2p+d) of cells, p = 2, be they squared errors of the flow or errors of a force, the fewest
    cells of a given sum Σ η_K² have the same part t each:

    h = h_K (t/η_K²)^(1/(2p+d)), t = (target/S)^((2p+d)/2p), S = Σ (η_K²)^(d/(2p+d))

    No edge changes by more than a factor of two from mesh to mesh. Nothing is asked for where no error is known. On
    bodies, where edges are bisected and nothing else, h/(LONGEST √AIM) is: no edge there stays longer than the accuracy
    allows, as a new mesh would else be made again and again.

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
        wanted = np.exp(flow.from_cells(np.log(flow.cell_edges * self._changes(error)), points))
        nearest, _ = around.two_nearest_bodies(points, float(flow.cell_edges.max()))
        wanted[nearest < _ON_BODIES * wanted] /= LONGEST * np.sqrt(_AIM)
        return np.asarray(np.minimum(wanted, longest))

    def is_due(self, error: EstimatedError, age: float, room: FloatArray | float = np.inf) -> bool:
        """Tell whether, after ``age`` whole steps on a mesh, another is worth it, with an ``error`` or a number of
        cells so much smaller; edges may grow by the factors ``room`` (M,) [1] at most."""
        if age < _SETTLED or not 0.0 < error.relative < np.inf:
            return False
        changes, is_new = np.minimum(self._changes(error), room), age < _LASTING
        if error.relative > self.accuracy:
            gain = np.sqrt(error.total / float(error.cells @ changes ** (2.0 * _ORDER)))
            return bool(gain > (_WORTH_SOON if is_new else _WORTH))
        grown = np.where(changes < _COLLAPSED, np.minimum(changes, 1.0), changes)
        return not is_new and _WORTH * float(np.sum(grown**-self.dimension)) < len(changes)

    def _changes(self, error: EstimatedError) -> FloatArray:
        """Wanted over present edge length of each cell (M,) [1]."""
        d, order = self.dimension, 2.0 * _ORDER + self.dimension
        relative, most = error.cells / error.total, _MOST**order
        weight = float(np.sum(relative ** (d / order)))
        target = _AIM**2 * (self.accuracy / error.relative) ** error.power
        each = max((target / weight) ** (order / (2.0 * _ORDER)), (weight / self.most_cells) ** (order / d))
        return np.asarray((each / np.clip(relative, each / most, each * most)) ** (1.0 / order))
