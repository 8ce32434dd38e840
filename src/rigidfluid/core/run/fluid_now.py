"""Fields of the fluid as it is now."""

from __future__ import annotations

from dataclasses import replace

from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System
from rigidfluid.core.output.fluid_fields import FluidFields


def fluid_now(system: System, state: State, time: float) -> FluidFields:
    """Fields of the fluid of a state at a time, with the viscosity of its material where that varies."""
    nodal = system.backend.fields(state.fluid, state.mesh)
    found = FluidFields.from_fields(replace(nodal, cell_errors=state.cell_errors), time)
    if system.fluid is None or isinstance(system.fluid.material, Newtonian):
        return found
    return replace(found, viscosity=system.fluid.material.viscosity(found.shear_rate))
