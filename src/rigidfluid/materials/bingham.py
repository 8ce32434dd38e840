"""Fluid that flows above a yield stress, with the same plastic viscosity at all shear rates."""

from __future__ import annotations

from typing import ClassVar

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.part import PartOptions
from rigidfluid.materials.yielding import Yielding, YieldingOptions


class BinghamOptions(YieldingOptions):
    """Keys of a ``[fluid.material]`` table with type ``bingham``."""


class Bingham(Yielding):
    """μ = μ_p + τ_y (1 - exp(-m γ̇)) / γ̇.

    References
    ----------
    T. C. Papanastasiou, Flows of materials with yield, J. Rheol. 31, 385 (1987).
    """

    name: ClassVar[str] = "bingham"
    Options: ClassVar[type[PartOptions]] = BinghamOptions

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        return self.options.viscosity + self.yielding_viscosity(shear_rate)
