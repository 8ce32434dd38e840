"""A backend that assembles SciPy's sparse matrices and leaves constraint, solution and step to this room."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, ClassVar, final

from rigidfluid.core.model.interfaces import PartOptions
from rigidfluid.core.model.types import BoolArray, FloatArray, FluidProblem, FluidState, Mesh
from rigidfluid.taylor_hood.backend import TaylorHoodBackend
from rigidfluid.taylor_hood.discretisation import Discretisation
from rigidfluid.taylor_hood.numbering import Numbering

if TYPE_CHECKING:
    from rigidfluid.taylor_hood.sparse import Assembly


class SparseBackend(TaylorHoodBackend):
    """One process; factors by PARDISO where it is installed and SuperLU elsewhere, kept from step to step."""

    oblique_faces: ClassVar[bool] = True
    periodic_faces: ClassVar[bool] = True

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        from rigidfluid.taylor_hood.lagged_factors import LaggedFactors
        from rigidfluid.taylor_hood.pardiso import Orderings

        super().__init__(options, problem)
        dimension, orderings = self.problem.dimension, Orderings()
        self._solver, self._inviscid_solver = (LaggedFactors(dimension, orderings) for _ in range(2))
        self._assembly: Assembly | None = None
        self._geometry: FloatArray

    @abstractmethod
    def assembly(self, numbering: Numbering) -> Assembly:
        """The integrals over the cells of a topology that was not seen before."""

    @final
    def discretise(self, numbering: Numbering, mesh: Mesh, controlled: BoolArray) -> Discretisation:
        from rigidfluid.taylor_hood.sparse import SparseDiscretisation

        if self._assembly is None or self._assembly.numbering is not numbering:
            self._assembly = self.assembly(numbering)
        self._geometry = mesh.geometry  # says which pressure is fixed, and the normals of faces
        solvers = self._solver, self._inviscid_solver
        return SparseDiscretisation(self.problem, self._assembly, *solvers, mesh, controlled)

    @final
    def memory(self) -> FluidState:
        from rigidfluid.taylor_hood.sparse import SparseDiscretisation

        self._latest_attempt = None
        if self._latest is None:
            return {}
        controlled, discretisation = self._latest
        assert isinstance(discretisation, SparseDiscretisation)
        return {"controlled": controlled.astype(float), "geometry": self._geometry} | discretisation.memory()

    @final
    def recall(self, memory: FluidState, mesh: Mesh | None) -> None:
        from rigidfluid.taylor_hood.sparse import SparseDiscretisation

        self.forget()
        if memory and mesh is not None:
            discretisation = self._on(mesh.at(memory["geometry"]), memory["controlled"].astype(bool))
            assert isinstance(discretisation, SparseDiscretisation)
            discretisation.recall(memory)

    @final
    def drop_factors(self) -> None:
        self._solver.forget()
        self._inviscid_solver.forget()
