"""Abstract class of materials whose viscosity varies with the shear rate."""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar

from rigidfluid.core.fluid.material import Material
from rigidfluid.core.geometry.answers import number, optional, rows
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.guarded import gives
from rigidfluid.core.model.part import SpatialPart


class GeneralisedNewtonian(SpatialPart, Material):
    """Generalised Newtonian fluid: its stress depends on the present shear rate γ̇ alone, 2 μ(γ̇) D with
    D = ½(∇u + ∇uᵀ) and γ̇ = √(2 D:D).

    Backends differentiate μ by log γ̇ for Newton's iteration, by differences over 2·10⁻⁵: it must be smooth. A step
    has one solution if the stress μ γ̇ grows with γ̇.

    Parameters
    ----------
    options : PartOptions
        The type's own keys of the ``[fluid.material]`` table.
    dimension : int
        2 or 3.
    """

    kind: ClassVar[str] = "material"

    dynamic_viscosity: float

    @property
    @gives(optional(number(0.0)))
    def yield_stress(self) -> float | None:
        """Stress below which it hardly flows, None where it flows under any [force/length^(d-1)]."""
        return None

    @abstractmethod
    @gives(rows(lambda _, shear_rate: shear_rate.shape, shorter=True, positive=True))
    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """Viscosity at each shear rate.

        Parameters
        ----------
        shear_rate : (N,) array
            γ̇ ≥ 0 [1/time].

        Returns
        -------
        (N,) array
            Positive and finite viscosities [mass·length^(2-d)/time].
        """
