"""Estimate of the error that a mesh makes: residuals of its cells over the dissipation of the flow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.state import State


@dataclass(frozen=True, eq=False)
class EstimatedError:
    """Squared errors ``cells`` (M,) of a mesh's cells in the norm of dissipation, and the flow's ``dissipation``
    [energy/time]."""

    cells: FloatArray
    dissipation: float

    @property
    def total(self) -> float:
        """Σ η_K² [energy/time]."""
        return float(self.cells.sum())

    @property
    def relative(self) -> float:
        """√(Σ η_K² / D), infinite in a fluid that dissipates nothing [1]."""
        return float(np.sqrt(self.total / self.dissipation)) if self.dissipation > 0.0 else np.inf


def mesh_error(state: State) -> EstimatedError | None:
    """Error of the mesh in the step to this ``state``; None where it was not estimated."""
    power = state.ledger.power
    return None if state.cell_errors is None or power is None else EstimatedError(state.cell_errors, power.dissipation)
