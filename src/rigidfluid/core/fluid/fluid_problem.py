"""The equations of the fluid, with all that they need on the boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from rigidfluid.core.fluid.conditions import BoundaryCondition
from rigidfluid.core.fluid.material import Material
from rigidfluid.core.fluid.scalar import ScalarProblem
from rigidfluid.core.geometry.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class FluidProblem:
    """The fluid's equations: ρ(∂u/∂t + ((u - w)·∇)u) = ∇·σ + source, ∇·u = 0, σ = -pI + μ(∇u + ∇uᵀ), with
    μ(γ̇) of the ``material``.

    With ``inertia`` False the left side is left out (Stokes). Without an open one among the ``conditions`` the pressure
    has zero mean. ``source(time, points)`` (N, d): force on the fluid alone [force/volume]. ``carrier`` (bodies,):
    the motion that carries each body, its own if not given. ``initial``: the flow at the start, at rest but
    for what bodies set in motion, steady, or the nearest to ``initial(0, points)`` (N, d) without divergence.
    ``scalar``: what the fluid carries along, if anything.
    """

    dimension: int
    bodies: int
    density: float
    material: Material
    inertia: bool
    conditions: tuple[BoundaryCondition, ...]
    source: Callable[[float, FloatArray], FloatArray] | None = None
    carrier: tuple[int, ...] = ()
    initial: Literal["rest", "steady"] | Callable[[float, FloatArray], FloatArray] = "rest"
    scalar: ScalarProblem | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "carrier", self.carrier or tuple(range(self.bodies)))

    def kinematic_viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ/ρ at each shear rate, (N,) [length²/time]."""
        return np.asarray(self.material.viscosity(shear_rate) / self.density)

    @property
    def motions(self) -> int:
        """Number of motions that carry the bodies."""
        return max(self.carrier, default=-1) + 1

    @property
    def inert_density(self) -> float:
        """The density in the left side: 0 in Stokes flow."""
        return self.density if self.inertia else 0.0

    @property
    def keeps_momentum(self) -> bool:
        """Tell whether fluid with inertia has nothing around it that takes momentum: all of the boundary is seams, and
        no flux is held through them."""
        return self.inertia and all(each.is_seam and each.held_flux is None for each in self.conditions)
