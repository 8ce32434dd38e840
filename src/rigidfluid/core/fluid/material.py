"""Material of a fluid: how it resists to being sheared."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray


class Material(ABC):
    """Viscosity of an incompressible fluid, σ = -pI + μ(γ̇)(∇u + ∇uᵀ) with the shear rate γ̇ = √(½|∇u + ∇uᵀ|²).

    A backend says which materials it solves for; a model with another one is refused.
    """

    name: ClassVar[str]

    dynamic_viscosity: float
    """Viscosity for scales and estimates, positive; where it varies, one of its size in a flow
    [mass·length^(2-d)/time]."""

    @abstractmethod
    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """Viscosity at each ``shear_rate`` (N,) [1/time], (N,) [mass·length^(2-d)/time]."""


@dataclass(frozen=True)
class Newtonian(Material):
    """The same viscosity at any shear rate [mass·length^(2-d)/time]."""

    dynamic_viscosity: float

    name: ClassVar[str] = "newtonian"

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """The viscosity, (N,) [mass·length^(2-d)/time]."""
        return np.full(len(shear_rate), self.dynamic_viscosity)
