"""Methods that discretisations and assemblies of backends for Newtonian fluids alone need not have."""

from __future__ import annotations

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates


class NewtonianOnly:
    """Viscous stress at quadrature points, which no `FluidBackend.materials` of such a backend asks for."""

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        raise NotImplementedError

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        raise NotImplementedError
