"""Fluid backend "dolfinx": assembly by DOLFINx, solution by PETSc, on one process or many."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, final

from scipy.sparse import csc_array

from rigidfluid.backends.dolfinx.options import DolfinxOptions
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Material, Newtonian
from rigidfluid.core.geometry.arrays import BoolArray
from rigidfluid.core.model.extension import Extension
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.backend import TaylorHoodBackend
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.solvers import Solvers
from rigidfluid.taylor_hood.system.discretisation import Discretisation

if TYPE_CHECKING:
    from rigidfluid.backends.dolfinx.discretisation import Topology
    from rigidfluid.backends.dolfinx.krylov import Krylov


@final
class Dolfinx(TaylorHoodBackend):
    """Under mpirun each process has a part of the mesh; preconditioners are kept from step to step."""

    name: ClassVar[str] = "dolfinx"
    materials: ClassVar[tuple[type[Material], ...]] = (Newtonian, GeneralisedNewtonian)
    requires: ClassVar[dict[str, str]] = {"dolfinx": "fenics-dolfinx (conda-forge, or python3-dolfinx of Debian 13)"}
    Options: ClassVar[type[PartOptions]] = DolfinxOptions
    options: DolfinxOptions

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        from mpi4py import MPI

        from rigidfluid.backends.dolfinx.krylov import LaggedLU, LaggedSchur
        from rigidfluid.core.model.ranks import MpiRanks

        super().__init__(options, problem)
        if MPI.COMM_WORLD.size > 1:
            self.ranks = MpiRanks(MPI.COMM_WORLD)
        by_schur = self.options.solver == "schur" or (self.options.solver == "auto" and self.problem.dimension == 3)
        kind = LaggedSchur if by_schur else LaggedLU
        given = self.ranks, self.problem.dimension, self.options.petsc
        self._solvers: Solvers[Krylov] = Solvers(kind(*given), kind(*given))
        self._topology: Topology | None = None

    def extension(self, mesh: Mesh, stiffness: csc_array, held: BoolArray) -> Extension:
        from rigidfluid.backends.dolfinx.extension import DistributedExtension

        if mesh.part is None:
            return super().extension(mesh, stiffness, held)
        return DistributedExtension(self._topology_of(self.numbering_of(mesh), mesh).space, stiffness, held)

    def discretise(self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray) -> Discretisation:
        from rigidfluid.backends.dolfinx.discretisation import PetscDiscretisation

        topology = self._topology_of(numbering, mesh)
        return PetscDiscretisation(self.problem, topology, self._solvers, mesh, prescribed)

    def drop_factors(self) -> None:
        self._solvers.viscous.forget()
        self._solvers.inviscid.forget()

    def _topology_of(self, numbering: Numbering, mesh: Mesh) -> Topology:
        from rigidfluid.backends.dolfinx.discretisation import Topology

        if self._topology is None or self._topology.numbering is not numbering:
            if self._topology is not None:
                self.drop_factors()
                self._topology.destroy()
            self._topology = Topology(numbering, mesh)
        return self._topology
