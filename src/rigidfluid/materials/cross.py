"""Fluid with a viscosity at rest and another at high shear rates, by a rational function."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.scene.table import Positive


class CrossOptions(PartOptions):
    """Keys of a ``[fluid.material]`` table with type ``cross``."""

    viscosity: Positive = Field(description="Viscosity μ₀ at rest [mass·length^(2-d)/time]")
    viscosity_infinite: float = Field(
        default=0.0, ge=0, description="Viscosity μ∞ at high shear rates [mass·length^(2-d)/time]"
    )
    relaxation_time: Positive = Field(description="Time λ: the viscosity is half-way at a shear rate of 1/λ [time]")
    exponent: float = Field(gt=0, le=1, description="Exponent m by which the viscosity falls [1]")


class Cross(GeneralisedNewtonian):
    """μ = μ∞ + (μ₀ - μ∞) / (1 + (λ γ̇)ᵐ).

    References
    ----------
    M. M. Cross, Rheology of non-Newtonian fluids: a new flow equation for pseudoplastic systems, J. Colloid Sci. 20,
    417 (1965).
    """

    name: ClassVar[str] = "cross"
    Options: ClassVar[type[PartOptions]] = CrossOptions
    options: CrossOptions

    def __init__(self, options: CrossOptions, dimension: int) -> None:
        super().__init__(options, dimension)
        self.dynamic_viscosity = options.viscosity

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        o = self.options
        thinned = 1.0 / (1.0 + (o.relaxation_time * shear_rate) ** o.exponent)
        return np.asarray(o.viscosity_infinite + (o.viscosity - o.viscosity_infinite) * thinned)
