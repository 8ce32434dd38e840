"""Contract tests of a fluid backend."""

from __future__ import annotations

from rigidfluid.testing.fluid.accuracy import AccuracyContract
from rigidfluid.testing.fluid.balances import BalancesContract
from rigidfluid.testing.fluid.boundary_forces import BoundaryForcesContract
from rigidfluid.testing.fluid.carried import CarriedContract
from rigidfluid.testing.fluid.curved import CurvedContract
from rigidfluid.testing.fluid.cylinder import CylinderContract
from rigidfluid.testing.fluid.exchange import ExchangeContract
from rigidfluid.testing.fluid.galilean import GalileanContract
from rigidfluid.testing.fluid.initial import InitialFlowContract
from rigidfluid.testing.fluid.linked import LinkedContract
from rigidfluid.testing.fluid.memory import MemoryContract
from rigidfluid.testing.fluid.oblique import ObliqueContract
from rigidfluid.testing.fluid.output import OutputContract
from rigidfluid.testing.fluid.periodic import PeriodicContract
from rigidfluid.testing.fluid.responses import ResponsesContract
from rigidfluid.testing.fluid.stresslets import StressletContract
from rigidfluid.testing.fluid.transfer import TransferContract
from rigidfluid.testing.fluid.varying_viscosity import VaryingViscosityContract


class FluidBackendContract(
    AccuracyContract,
    BalancesContract,
    BoundaryForcesContract,
    CarriedContract,
    CurvedContract,
    CylinderContract,
    ExchangeContract,
    GalileanContract,
    InitialFlowContract,
    LinkedContract,
    ObliqueContract,
    PeriodicContract,
    StressletContract,
    ResponsesContract,
    TransferContract,
    VaryingViscosityContract,
    MemoryContract,
    OutputContract,
):
    """Fluid and bodies in 2D and 3D, by results alone and not by how a backend lays out its state.

    Set the class attribute ``backend``, and ``options`` if it has some. Override ``make_backend`` for one that is made
    in another way, and ``make_mesh`` where each process holds a part of the mesh.
    """
