"""Fluid backend "scikit-fem": quadrature and basis functions by scikit-fem, loops compiled by numba, one process."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, final

from rigidfluid.core.interfaces import PartOptions
from rigidfluid.core.types import BoolArray, FluidProblem, Mesh
from rigidfluid.taylor_hood.backend import TaylorHoodBackend
from rigidfluid.taylor_hood.discretisation import Discretisation
from rigidfluid.taylor_hood.numbering import Numbering

if TYPE_CHECKING:
    from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly


@final
class ScikitFem(TaylorHoodBackend):
    """Factors by PARDISO where it is installed and SuperLU elsewhere; they are kept from step to step."""

    name: ClassVar[str] = "scikit-fem"
    requires: ClassVar[dict[str, str]] = {"skfem": "scikit-fem", "numba": "numba"}

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        from rigidfluid.taylor_hood.stale_solver import StaleSolver

        super().__init__(options, problem)
        self._solver = StaleSolver()
        self._assembly: CompiledAssembly | None = None

    def discretise(self, numbering: Numbering, mesh: Mesh, controlled: BoolArray) -> Discretisation:
        from rigidfluid.backends.scikit_fem.assembly import CompiledAssembly
        from rigidfluid.taylor_hood.sparse import SparseDiscretisation

        if self._assembly is None or self._assembly.numbering is not numbering:
            self._assembly = CompiledAssembly(numbering)
        return SparseDiscretisation(self.problem, self._assembly, self._solver, mesh, controlled)

    def drop_factors(self) -> None:
        self._solver.forget()
