"""Fluid with a viscosity at rest, another at high shear rates, and a power law between them."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive


class CarreauOptions(PartOptions):
    """Keys of a ``[fluid.material]`` table with type ``carreau``, of Carreau and Yasuda."""

    viscosity: Positive = Field(description="Viscosity μ₀ at rest [mass·length^(2-d)/time]")
    viscosity_infinite: float = Field(
        default=0.0, ge=0, description="Viscosity μ∞ at high shear rates [mass·length^(2-d)/time]"
    )
    relaxation_time: Positive = Field(
        description="Time λ: the viscosity leaves that at rest at shear rates about 1/λ [time]"
    )
    exponent: float = Field(
        gt=0, le=2, description="Exponent n of the stress in between; below 1 it is shear-thinning [1]"
    )
    transition: float = Field(
        default=2.0, gt=0, le=20, description="Yasuda's exponent a: the higher, the sharper the transition at rest [1]"
    )


class Carreau(GeneralisedNewtonian):
    """μ = μ∞ + (μ₀ - μ∞) (1 + (λ γ̇)ᵃ)^((n - 1)/a).

    References
    ----------
    P. J. Carreau, Rheological equations from molecular network theories, Trans. Soc. Rheol. 16, 99 (1972); K. Yasuda,
    R. C. Armstrong and R. E. Cohen, Shear flow properties of concentrated solutions of linear and star branched
    polystyrenes, Rheol. Acta 20, 163 (1981).
    """

    name: ClassVar[str] = "carreau"
    also_called: ClassVar[tuple[str, ...]] = ("carreau-yasuda", "carreau_yasuda")
    Options: ClassVar[type[PartOptions]] = CarreauOptions
    options: CarreauOptions

    def __init__(self, options: CarreauOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.dynamic_viscosity = options.viscosity

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        o = self.options
        thinned = (1.0 + (o.relaxation_time * shear_rate) ** o.transition) ** ((o.exponent - 1.0) / o.transition)
        return np.asarray(o.viscosity_infinite + (o.viscosity - o.viscosity_infinite) * thinned)
