"""Base of fluids that flow above a yield stress, made smooth at rest."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive


class YieldingOptions(PartOptions):
    """Keys that all fluids with a yield stress have."""

    viscosity: Positive = Field(description="Plastic viscosity μ_p [mass·length^(2-d)/time]")
    yield_stress: Positive = Field(description="Yield stress τ_y [force/length^(d-1)]")
    stress_growth: Positive = Field(
        description="Papanastasiou's time m: below the yield stress it flows with a viscosity of about m τ_y [time]"
    )


class Yielding(GeneralisedNewtonian):
    """Fluid with a yield stress; a class gives the rest of its viscosity.

    References
    ----------
    T. C. Papanastasiou, Flows of materials with yield, J. Rheol. 31, 385 (1987).
    """

    options: YieldingOptions

    def __init__(self, options: YieldingOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.dynamic_viscosity = options.viscosity

    @property
    def yield_stress(self) -> float:
        """τ_y [force/length^(d-1)]."""
        return self.options.yield_stress

    def yielding_viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """τ_y (1 - exp(-m γ̇)) / γ̇ of shear rates (N,) [1/time]: m τ_y at rest."""
        grown = self.options.stress_growth * shear_rate
        share = np.ones_like(grown)
        np.divide(-np.expm1(-grown), grown, out=share, where=grown > 0.0)
        return np.asarray(self.options.yield_stress * self.options.stress_growth * share)
