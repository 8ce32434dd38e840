"""Estimates of the error that a mesh makes: parts of cells, over what they are errors of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System


@dataclass(frozen=True, eq=False)
class EstimatedError:
    """Parts ``cells`` (M,) of a mesh's cells in an error that is relative to a ``whole`` of the same unit: with a
    ``power`` of 2 [1] their sum is the square of the error.

    Parts of the flow are squared errors in the norm of dissipation, and the whole is the dissipation [energy/time].
    """

    cells: FloatArray
    whole: float
    power: float = 2.0

    @property
    def total(self) -> float:
        """Σ of the parts, in their unit."""
        return float(self.cells.sum())

    @property
    def relative(self) -> float:
        """(Σ / whole)^(1/power), infinite where the whole is zero [1]."""
        return float((self.total / self.whole) ** (1.0 / self.power)) if self.whole > 0.0 else np.inf


class ErrorEstimate(ABC):
    """Error that cells follow with `mesh.accuracy`."""

    @abstractmethod
    def is_asked(self, steps: float, age: float) -> bool:
        """Tell whether a mesh is judged by it after so many whole ``steps``, ``age`` of them on this mesh [1]."""

    @abstractmethod
    def error(self, system: System, state: State) -> EstimatedError | None:
        """Error of a ``state``'s mesh, whose bodies are those of the ``system`` now; None where it cannot be told."""


class ErrorOfFlow(ErrorEstimate):
    """Error of velocity gradients and pressure, which each step estimates."""

    def is_asked(self, steps: float, age: float) -> bool:
        """Always: it is known."""
        return True

    def error(self, system: System, state: State) -> EstimatedError | None:
        """Error of the mesh in the step to this ``state``; None where it was not estimated."""
        return mesh_error(state)


def mesh_error(state: State) -> EstimatedError | None:
    """Error of the flow that the mesh made in the step to this ``state``; None where it was not estimated."""
    power = state.ledger.power
    return None if state.cell_errors is None or power is None else EstimatedError(state.cell_errors, power.dissipation)
