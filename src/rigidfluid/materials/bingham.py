"""Fluid that flows above a yield stress, with the same plastic viscosity at all shear rates."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive
from rigidfluid.materials.yielding import yielding_viscosity


class BinghamOptions(PartOptions):
    """Keys of a ``[fluid.material]`` table with type ``bingham``."""

    viscosity: Positive = Field(description="Plastic viscosity μ_p [mass·length^(2-d)/time]")
    yield_stress: Positive = Field(description="Yield stress τ_y [force/length^(d-1)]")
    stress_growth: Positive = Field(
        description="Papanastasiou's time m: below the yield stress it flows with a viscosity of m τ_y [time]"
    )


class Bingham(GeneralisedNewtonian):
    """μ = μ_p + τ_y (1 - exp(-m γ̇)) / γ̇.

    References
    ----------
    T. C. Papanastasiou, Flows of materials with yield, J. Rheol. 31, 385 (1987).
    """

    name: ClassVar[str] = "bingham"
    Options: ClassVar[type[PartOptions]] = BinghamOptions
    options: BinghamOptions

    def __init__(self, options: BinghamOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.dynamic_viscosity = options.viscosity

    @property
    def yield_stress(self) -> float:
        """τ_y [force/length^(d-1)]."""
        return self.options.yield_stress

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        o = self.options
        return o.viscosity + yielding_viscosity(shear_rate, o.yield_stress, o.stress_growth)
