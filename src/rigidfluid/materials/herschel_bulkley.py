"""Fluid that flows above a yield stress, by a power law."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive
from rigidfluid.materials.yielding import Yielding, YieldingOptions


class HerschelBulkleyOptions(YieldingOptions):
    """Keys of a ``[fluid.material]`` table with type ``herschel_bulkley``; the consistency is K = μ₁ γ̇₁^(1 - n)."""

    viscosity: Positive = Field(
        description="Part μ₁ of the viscosity at the shear rate `shear_rate` that is not of the yield stress "
        "[mass·length^(2-d)/time]"
    )
    shear_rate: Positive = Field(description="Shear rate γ̇₁ with that viscosity [1/time]")
    exponent: float = Field(gt=0, le=2, description="Exponent n of the stress; below 1 it is shear-thinning [1]")


class HerschelBulkley(Yielding):
    """μ = μ₁ ((γ̇² + m⁻²) / γ̇₁²)^((n - 1)/2) + τ_y (1 - exp(-m γ̇)) / γ̇; with n = 1 a Bingham fluid.

    References
    ----------
    W. H. Herschel and R. Bulkley, Konsistenzmessungen von Gummi-Benzollösungen, Kolloid-Z. 39, 291 (1926); T. C.
    Papanastasiou, Flows of materials with yield, J. Rheol. 31, 385 (1987).
    """

    name: ClassVar[str] = "herschel_bulkley"
    also_called: ClassVar[tuple[str, ...]] = ("herschel-bulkley",)
    Options: ClassVar[type[PartOptions]] = HerschelBulkleyOptions
    options: HerschelBulkleyOptions

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        o = self.options
        relative = np.hypot(shear_rate, 1.0 / o.stress_growth) / o.shear_rate
        flowing = o.viscosity * relative ** (o.exponent - 1.0)
        return np.asarray(flowing + self.yielding_viscosity(shear_rate))
