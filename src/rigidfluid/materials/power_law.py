"""Fluid whose stress is a power of the shear rate, with a bounded viscosity at rest."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive


class PowerLawOptions(PartOptions):
    """Keys of a ``[fluid.material]`` table with type ``power_law``; the consistency is K = μ₁ γ̇₁^(1 - n)."""

    viscosity: Positive = Field(description="Viscosity μ₁ at the shear rate `shear_rate` [mass·length^(2-d)/time]")
    shear_rate: Positive = Field(description="Shear rate γ̇₁ with that viscosity [1/time]")
    exponent: float = Field(gt=0, le=2, description="Exponent n of the stress; below 1 it is shear-thinning [1]")
    least_shear_rate: Positive = Field(
        description="Shear rate ε below which the viscosity stays nearly as it is at rest [1/time]"
    )


class PowerLaw(GeneralisedNewtonian):
    """μ = μ₁ ((γ̇² + ε²) / γ̇₁²)^((n - 1)/2), the law of Ostwald and de Waele for γ̇ ≫ ε."""

    name: ClassVar[str] = "power_law"
    also_called: ClassVar[tuple[str, ...]] = ("power-law", "ostwald-de-waele")
    Options: ClassVar[type[PartOptions]] = PowerLawOptions
    options: PowerLawOptions

    def __init__(self, options: PowerLawOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.dynamic_viscosity = options.viscosity

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        o = self.options
        relative = np.hypot(shear_rate, o.least_shear_rate) / o.shear_rate
        return np.asarray(o.viscosity * relative ** (o.exponent - 1.0))
