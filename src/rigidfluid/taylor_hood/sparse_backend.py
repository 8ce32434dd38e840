"""A backend that assembles SciPy's sparse matrices and leaves constraint, solution and step to this room."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Literal, final

import numpy as np
from pydantic import Field

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.answers import refuse_other_rows
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.flow_error import RefinedFlow
from rigidfluid.core.model.neighbour_step import NeighbourEnd, NeighbourPair, NeighbourStep
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import FluidState, Mesh, SolverCost, Step
from rigidfluid.taylor_hood.backend import TaylorHoodBackend, TaylorHoodOptions, on_mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.linear_solver.predicted_cost import predicted_factors, predicted_run, predicted_unknowns
from rigidfluid.taylor_hood.linear_solver.solvers import Solvers

if TYPE_CHECKING:
    from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver
    from rigidfluid.taylor_hood.linear_solver.sparse import Assembly, SparseDiscretisation
    from rigidfluid.taylor_hood.stepping.refined_flow import InPlace
    from rigidfluid.taylor_hood.system.parts import Parts

_DEAR = 1.0
"""Factors in 3D that are predicted to take as many seconds, with 22,000 unknowns and 180 MB, cost more than blocks."""

_ITERATED = 2.0
"""Cost of a step with a viscosity that varies, over that of one without: for a falling disk it was 1.8 and 2.0."""


class SparseOptions(TaylorHoodOptions):
    """Keys of ``[fluid]`` that these backends read."""

    solver: Literal["auto", "lu", "schur"] = Field(
        "auto",
        description="`lu` factorises the whole matrix; `schur` works by blocks and needs far less memory in 3D; "
        "`auto`: `lu` in 2D and for small meshes in 3D, else `schur`",
    )


class SparseBackend(TaylorHoodBackend):
    """One process; the whole matrix or blocks of it are factorised, by PARDISO where it is installed and SuperLU
    elsewhere, and kept from step to step."""

    Options: ClassVar[type[PartOptions]] = SparseOptions
    oblique_faces: ClassVar[bool] = True
    periodic_faces: ClassVar[bool] = True
    exchanges_bodies: ClassVar[bool] = True
    held_fluxes: ClassVar[bool] = True
    stresslets: ClassVar[bool] = True
    boundary_forces: ClassVar[bool] = True
    cell_errors: ClassVar[bool] = True
    tangents: ClassVar[bool] = True

    options: SparseOptions

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        from rigidfluid.taylor_hood.linear_solver.lagged_factors import LaggedFactors
        from rigidfluid.taylor_hood.linear_solver.pardiso import Orderings
        from rigidfluid.taylor_hood.schur.lagged_schur import LaggedSchur

        super().__init__(options, problem)
        dimension, orderings = self.problem.dimension, Orderings()
        self._solvers: dict[str, Solvers[LaggedSolver[Parts]]] = {
            "lu": Solvers(LaggedFactors(dimension, orderings), LaggedFactors(dimension, orderings)),
            "schur": Solvers(LaggedSchur(dimension), LaggedSchur(dimension)),
        }
        self._assembly: Assembly | None = None
        self._geometry: FloatArray

    @abstractmethod
    def assembly(self, numbering: Numbering) -> Assembly:
        """The integrals over the cells of a topology that was not seen before."""

    @final
    def discretise(self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray) -> SparseDiscretisation:
        return self._discretised(numbering, mesh, prescribed, self._method(numbering.unknowns))

    @final
    def discretise_steady(self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray) -> SparseDiscretisation:
        """Discretise by LU factors where there is convection: without inertia blocks do not master it."""
        method = "lu" if self.problem.inertia else self._method(numbering.unknowns)
        return self._discretised(numbering, mesh, prescribed, method)

    def _discretised(
        self, numbering: Numbering, mesh: Mesh, prescribed: BoolArray, method: str
    ) -> SparseDiscretisation:
        from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation

        if self._assembly is None or self._assembly.numbering is not numbering:
            self._assembly = self.assembly(numbering)
        self._geometry = mesh.geometry  # says which pressure is fixed, and the normals of faces
        return SparseDiscretisation(self.problem, self._assembly, self._solvers[method], mesh, prescribed)

    @final
    def neighbours(
        self, solved: NeighbourStep, found: FluidState, pairs: Sequence[NeighbourPair]
    ) -> list[tuple[NeighbourEnd, NeighbourEnd]]:
        from rigidfluid.taylor_hood.stepping.neighbours import neighbours

        discretisation = self._discretisation(solved.mesh, solved.step.prescribed)
        asked = [(_with_images(plus), _with_images(minus)) for plus, minus in pairs]
        return neighbours(discretisation, _with_images(solved), found, asked, self.options.tolerance)

    @final
    def force_errors(self, flow: RefinedFlow, step: Step) -> FloatArray:
        from rigidfluid.taylor_hood.stepping.force_errors import force_errors

        return force_errors(self.held_in_place(flow, step), flow.fluid, self.numbering_of(flow.mesh), flow.mesh)

    @final
    def held_in_place(self, flow: RefinedFlow, step: Step) -> InPlace:
        """The ``step`` on the finer mesh with all motions prescribed, beside the run's own factors."""
        from rigidfluid.taylor_hood.stepping.refined_flow import InPlace

        target = type(self)(self.options, self.problem)._steady_discretisation(flow.finer)
        held = replace(step, points=flow.finer.geometry, prescribed=np.ones_like(step.prescribed))
        return InPlace(target, flow.finer, on_mesh(held, flow.mesh), self.options.tolerance)

    @final
    def memory(self) -> FluidState:
        from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation

        self._latest_attempt = None
        if self._latest is None:
            return {}
        prescribed, discretisation = self._latest[0], self._latest[1].inner
        assert isinstance(discretisation, SparseDiscretisation)
        return {"controlled": prescribed.astype(float), "geometry": self._geometry} | discretisation.memory()

    @final
    def recall(self, memory: FluidState, mesh: Mesh) -> None:
        from rigidfluid.taylor_hood.linear_solver.sparse import SparseDiscretisation

        self.forget()
        if memory:
            refuse_other_rows(memory["controlled"], (self.problem.motions,), "controlled")
            refuse_other_rows(memory["geometry"], mesh.geometry.shape, "geometry")
            there = mesh.moved_to(memory["geometry"])
            discretisation = self._discretisation(there, memory["controlled"].astype(bool)).inner
            assert isinstance(discretisation, SparseDiscretisation)
            discretisation.recall(memory)

    @final
    def drop_factors(self) -> None:
        for solvers in self._solvers.values():
            solvers.viscous.forget()
            solvers.inviscid.forget()

    @final
    def solver_cost(self, cells: float, facets: float) -> SolverCost | None:
        unknowns = predicted_unknowns(cells, facets, self.problem.dimension)
        cost = predicted_run(self._method(unknowns), unknowns, self.problem.dimension, self.problem.inertia)
        if isinstance(self.problem.material, Newtonian):
            return cost
        return replace(cost, step_seconds=_ITERATED * cost.step_seconds)

    def _method(self, unknowns: float) -> Literal["lu", "schur"]:
        if self.options.solver != "auto":
            return self.options.solver
        dimension = self.problem.dimension
        return "schur" if dimension == 3 and predicted_factors(unknowns, dimension).seconds > _DEAR else "lu"


def _with_images(at: NeighbourStep) -> NeighbourStep:
    """The same with the poses of images that are on the mesh."""
    return replace(at, step=on_mesh(at.step, at.mesh))
