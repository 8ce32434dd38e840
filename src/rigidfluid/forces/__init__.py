"""The force laws that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.forces.barrier import BarrierLaw
from rigidfluid.forces.centre import CentreLaw
from rigidfluid.forces.contact import ContactPointLaw
from rigidfluid.forces.dipole import DipoleLaw
from rigidfluid.forces.lubrication import LubricationLaw
from rigidfluid.forces.normal import NormalLaw
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw
from rigidfluid.forces.van_der_waals import VanDerWaalsLaw
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_force_laws() -> list[type[ForceLaw]]:
    """The built-in force laws."""
    return [
        CentreLaw,
        ContactPointLaw,
        NormalLaw,
        BarrierLaw,
        SpringDashpotLaw,
        LubricationLaw,
        VanDerWaalsLaw,
        DipoleLaw,
    ]
