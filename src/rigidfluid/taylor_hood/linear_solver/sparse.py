"""The equations in SciPy's sparse matrices, in one process."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple, Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.answers import refuse_other_rows
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.linear_solver.lagged_solver import LaggedSolver, Operator
from rigidfluid.taylor_hood.linear_solver.pardiso import Orderings
from rigidfluid.taylor_hood.linear_solver.projection import Masses, SparseProjection
from rigidfluid.taylor_hood.linear_solver.solvers import Solvers
from rigidfluid.taylor_hood.system.coefficients import Coefficients, coefficients_of
from rigidfluid.taylor_hood.system.constraint import Constraint
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution
from rigidfluid.taylor_hood.system.local_viscosity import LocalViscosity, StrainRates
from rigidfluid.taylor_hood.system.parts import Parts
from rigidfluid.taylor_hood.system.reduced_matrix import ReducedMatrix

_OUTDATED = 0.1
"""Relative difference of the BDF weights of two steps, from which on the factors of one serve the other badly: with
those of BDF1 a step of BDF2 takes 5 to 7 iterations."""

_ORIGIN = ("points", "inertia", "viscosity", "advection", "flow", "position", "mass_matrix", "frame")
"""Fields of a `CoupledMatrix` that the others follow from."""

_NAMES = {True: "step", False: "masses"}


class Assembly(Protocol):
    """Integrals over the cells of one topology, in the numbers of ``numbering``."""

    numbering: Numbering

    def matrix(self, points: FloatArray, coefficients: Coefficients) -> sparse.csr_array:
        """Matrix K of these coefficients; all matrices have one sparsity pattern, zeros kept."""

    def masses(self, points: FloatArray) -> Masses:
        """The parts of K for projections: both patterns are the same for all ``points``, zeros kept."""

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function, (nodes, d)."""

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ)."""

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        """∇u + ∇uᵀ at the points by which viscous stress is integrated."""

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        """(stress, ∇v) for every nodal test function, (nodes, d), of ``stress`` (N, d, d) at those points."""

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        """∫ w (∇·u)², ``weight`` w (M,)."""


@dataclass(frozen=True, eq=False)
class _Assembled:
    """Pᵀ K P of a `CoupledMatrix` with the ``masses`` (n, d+k, d+k) of the free motions: K ``system_matrix``, P of the
    ``constraint``, with the ``coefficients`` in K."""

    coupled: CoupledMatrix
    system_matrix: sparse.csr_array
    constraint: Constraint
    masses: FloatArray
    coefficients: Coefficients

    @property
    def twists(self) -> slice:
        """The twists among the unknowns."""
        first = self.constraint.twist_start
        return slice(first, first + self.masses.shape[0] * self.masses.shape[1])

    def apply(self, x: FloatArray) -> FloatArray:
        """The matrix times x (unknowns,) or (unknowns, c)."""
        result: FloatArray = self.constraint.transposed @ (self.system_matrix @ (self.constraint.matrix @ x))
        of_bodies = x[self.twists].reshape(*self.masses.shape[:2], *x.shape[1:])
        moved = np.einsum("nij,nj...->ni...", self.masses, of_bodies)
        result[self.twists] += moved.reshape(x[self.twists].shape)
        return result

    def moved(self, solution: Solution, change: FloatArray) -> Solution:
        """A ``solution`` with its unknowns moved by a ``change`` (unknowns,)."""
        everything, twist = self.constraint.matrix @ change, solution.twist.copy()
        twist[~self.coupled.prescribed] += change[self.twists].reshape(-1, twist.shape[1])
        shape, size = solution.velocity.shape, solution.velocity.size
        return replace(
            solution,
            velocity=solution.velocity + everything[:size].reshape(shape),
            pressure=solution.pressure + everything[size:],
            twist=twist,
            reaction=solution.reaction + (self.system_matrix @ everything)[:size].reshape(shape),
        )


class _Beside(NamedTuple):
    """A system's ``residual`` (unknowns,) of unknowns that may not solve it, and these as its ``solution``."""

    residual: FloatArray
    solution: Solution


@dataclass(frozen=True, eq=False)
class _Posed:
    """A ``system`` with its ``assembled`` matrix: what is ``given`` of all unknowns of K, their ``load``, and the
    ``right_side`` (unknowns,). It is asked while P is placed for it."""

    system: CoupledSystem
    assembled: _Assembled
    given: FloatArray
    load: FloatArray
    right_side: FloatArray

    def residual(self, x: FloatArray) -> FloatArray:
        """Right side less the matrix times x (unknowns,)."""
        return np.asarray(self.right_side - self.assembled.apply(x))

    def beside(self, x: FloatArray) -> _Beside:
        """The residual of x (unknowns,), and x as a solution."""
        return _Beside(self.residual(x), self.solution(x))

    def solution(self, x: FloatArray) -> Solution:
        """Velocity, pressure, twists and reaction of the unknowns x (unknowns,)."""
        s, assembled = self.system, self.assembled
        everything = assembled.constraint.matrix @ x + self.given
        twist = s.twist.copy()
        twist[~s.matrix.prescribed] = x[assembled.twists].reshape(-1, twist.shape[1])
        velocity, pressure = np.split(everything, [s.prescribed.size])
        reaction = (assembled.system_matrix @ everything - self.load)[: s.prescribed.size]
        jump_load = None
        if s.pressure_jump.any():
            of_jump = assembled.system_matrix @ np.concatenate([np.zeros(s.prescribed.size), s.pressure_jump])
            jump_load = -of_jump[: s.prescribed.size].reshape(s.prescribed.shape)
        velocity = velocity.reshape(s.prescribed.shape) + s.matrix.frame
        return Solution(velocity, pressure, twist, reaction.reshape(s.prescribed.shape), jump_load)


class SparseDiscretisation:
    """Pᵀ K P, solved by a Krylov iteration.

    Parameters
    ----------
    problem : FluidProblem
        Equations and boundary conditions.
    assembly : Assembly
        The integrals.
    solvers : Solvers
        Kept from topology to topology; they must have been told to forget the last one.
    mesh : Mesh
        The topology.
    prescribed : (N,) bool
        Motions whose twist is prescribed.
    """

    def __init__(
        self,
        problem: FluidProblem,
        assembly: Assembly,
        solvers: Solvers[LaggedSolver[Parts]],
        mesh: Mesh,
        prescribed: BoolArray,
    ) -> None:
        self.problem = problem
        self.numbering = assembly.numbering
        self.surfaces = Surfaces(assembly.numbering, mesh, problem.conditions, problem.carrier)
        self._constraint = Constraint(self.surfaces, mesh, prescribed)
        self._assembly = assembly
        self._solvers = solvers
        self._latest: dict[bool, _Assembled] = {}
        self._reduced: ReducedMatrix | None = None
        self._orderings = Orderings()
        self._made_from: dict[bool, CoupledMatrix] = {}

    @property
    def unknowns(self) -> int:
        return int(self._constraint.unknowns)

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        return self._assembly.mass_times(points, field)

    def projection(self, points: FloatArray, position: FloatArray) -> SparseProjection:
        self._constraint.place(self.numbering.node_points(points), position)
        return SparseProjection(self._assembly.masses(points), self._constraint, self._orderings)

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        return self._assembly.strain_square(points, velocity)

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        return self._assembly.strain_rates(points, velocity)

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        return self._assembly.stress_load(points, stress)

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        return self._assembly.divergence_square(points, velocity, weight)

    def solve(self, system: CoupledSystem, tolerance: float) -> Solution:
        """Solve Pᵀ(K(P x + given - frame) - load) + (M x - L on the twists) = 0 from the guess onwards."""
        solver = self._solvers.select(system.matrix.viscosity)
        posed = self._posed(system, self._assembled(system.matrix))
        guess = self._guess(system, posed.assembled.twists)
        scale = max(solver.norm(posed.right_side), system.scale)
        guess *= scale > 0.0  # what nothing drives is exactly at rest, and no residual could be small beside zero
        enough, outdated = tolerance * scale, self._is_outdated(system.matrix)
        operator = self._operator(posed.assembled)
        correction, _ = solver.solve(operator, posed.residual(guess), enough, outdated, system.again)
        return posed.solution(guess + correction)

    def residual(self, system: CoupledSystem) -> FloatArray:
        everything = np.concatenate([(system.velocity - system.matrix.frame).ravel(), system.pressure])
        found = np.asarray(self._assembled(system.matrix).system_matrix @ everything)
        found[: system.load.size] -= system.load.ravel()
        return found

    def neighbours(
        self, system: CoupledSystem, pairs: Sequence[tuple[CoupledSystem, CoupledSystem]], tolerance: float
    ) -> list[tuple[Solution, Solution]]:
        """Solutions x ± δ of ``pairs`` of systems that differ little from one with the solution x, to first order:
        its matrix times δ is half the difference of the pair's residuals r₊(x) and r₋(x).

        The ``system`` has its solution as guess, which is improved first where it is none.
        """
        solver, assembled = self._solvers.select(system.matrix.viscosity), self._assembled(system.matrix)
        posed, operator = self._posed(system, assembled), self._operator(assembled)
        x = self._guess(system, assembled.twists)
        missed = posed.residual(x)
        if solver.norm(missed) > tolerance * max(solver.norm(posed.right_side), system.scale):
            x += solver.solve_aside(operator, missed[:, None], tolerance)[:, 0]
        found = [[self._posed(each, self._assemble(each.matrix)).beside(x) for each in pair] for pair in pairs]
        self._constraint.place(system.matrix.node_points, system.matrix.position)
        half = [0.5 * (plus.residual - minus.residual) for plus, minus in found]
        changes = solver.solve_aside(operator, np.stack(half, axis=1), tolerance)
        return [
            (assembled.moved(plus.solution, change), assembled.moved(minus.solution, -change))
            for (plus, minus), change in zip(found, changes.T, strict=True)
        ]

    def twist_response(self, matrix: CoupledMatrix, wrenches: FloatArray, tolerance: float) -> FloatArray:
        assembled, free = self._assembled(matrix), ~matrix.prescribed
        found, loads = np.zeros_like(wrenches), wrenches[free].reshape(-1, wrenches.shape[2])
        given = self._operator(assembled), self._right_sides(assembled, loads), tolerance
        responses = self._solvers.select(matrix.viscosity).solve_loads(*given, loads)[assembled.twists]
        found[free] = responses.reshape(-1, *wrenches.shape[1:])
        return found

    def velocity_response(self, matrix: CoupledMatrix, wrench: FloatArray, tolerance: float) -> FloatArray:
        assembled, loads = self._assembled(matrix), wrench[~matrix.prescribed].reshape(-1, 1)
        given = self._operator(assembled), self._right_sides(assembled, loads), tolerance
        response = self._solvers.select(matrix.viscosity).solve_columns(*given)[:, 0]
        size = self.numbering.nodes * self.numbering.dimension
        return np.asarray((self._constraint.matrix @ response)[:size].reshape(self.numbering.nodes, -1))

    def memory(self) -> dict[str, FloatArray]:
        """Arrays that the next step depends on besides the state: the matrices of the factors, and the solvers'
        memories."""
        found: dict[str, FloatArray] = {}
        for viscous, solver in self._named_solvers():
            if solver.is_made:
                origin = self._made_from[viscous]
                arrays = {name: np.asarray(getattr(origin, name)) for name in _ORIGIN} | origin.local.memory()
                found |= {f"{_NAMES[viscous]}_{name}": each for name, each in (arrays | solver.memory()).items()}
        return found

    def recall(self, memory: Mapping[str, FloatArray]) -> None:
        """Make the factors of a `memory` again, to the last bit."""
        for viscous, solver in self._named_solvers():
            prefix = f"{_NAMES[viscous]}_"
            found = {name.removeprefix(prefix): each for name, each in memory.items() if name.startswith(prefix)}
            if found:
                self._refuse_other(found)
                solver.recall(found, partial(self._parts, self._assembled(self._origin(found))))

    def _refuse_other(self, memory: Mapping[str, FloatArray]) -> None:
        """Raise `Wrong` where a solver's `memory` is of another mesh, or of other numbers of bodies and motions."""
        nodes, (count,) = (self.numbering.nodes, self.numbering.dimension), self._constraint.prescribed.shape
        directions = memory["mass_matrix"].shape[-1:]
        shapes = {
            "advection": nodes,
            "flow": nodes,
            "position": (len(self.surfaces.body_nodes), nodes[1]),
            "frame": nodes[1:],
        }
        shapes |= {"mass_matrix": (count, *directions, *directions)}
        twists = self.unknowns - len(self._constraint.free_unknowns)
        for name, width in (("corrections", self.unknowns), ("answers", self.unknowns), ("loads", twists)):
            if memory[name].size:
                shapes[name] = len(memory[name]), width
        for name, shape in shapes.items():
            refuse_other_rows(memory[name], shape, name)
        if LocalViscosity.is_in(memory):
            refuse_other_rows(
                memory["points"], (self.numbering.vertices + len(self.numbering.on_curves), nodes[1]), "points"
            )
            points = len(self._assembly.strain_rates(memory["points"], memory["flow"]).weight)
            for name, shape in LocalViscosity.shapes(points, len(self.numbering.cells), nodes[1]).items():
                refuse_other_rows(memory[name], shape, name)

    def _named_solvers(self) -> tuple[tuple[bool, LaggedSolver[Parts]], ...]:
        """Each solver, and whether it is the one for viscous matrices."""
        return (True, self._solvers.viscous), (False, self._solvers.inviscid)

    def _origin(self, memory: Mapping[str, FloatArray]) -> CoupledMatrix:
        return CoupledMatrix(
            points=memory["points"],
            node_points=self.numbering.node_points(memory["points"]),
            inertia=float(memory["inertia"]),
            viscosity=float(memory["viscosity"]),
            advection=memory["advection"],
            flow=memory["flow"],
            position=memory["position"],
            mass_matrix=memory["mass_matrix"],
            prescribed=self._constraint.prescribed,
            frame=memory["frame"],
            local=LocalViscosity.recalled(memory),
        )

    def _right_sides(self, assembled: _Assembled, loads: FloatArray) -> FloatArray:
        """Right sides (unknowns, c) of ``loads`` (t, c) on the free motions alone."""
        right_sides = np.zeros((self.unknowns, loads.shape[1]), order="F")
        right_sides[assembled.twists] = loads
        return right_sides

    def _assembled(self, matrix: CoupledMatrix) -> _Assembled:
        """The latest of a step and the latest of its masses are kept, since both are asked again how bodies answer."""
        viscous = matrix.viscosity != 0.0
        if viscous not in self._latest or self._latest[viscous].coupled is not matrix:
            self._latest.pop(viscous, None)  # frees the one before
            self._latest[viscous] = self._assemble(matrix)
        return self._latest[viscous]

    def _assemble(self, m: CoupledMatrix) -> _Assembled:
        coefficients = coefficients_of(self.numbering, m)
        system_matrix = self._assembly.matrix(m.points, coefficients)
        self._constraint.place(m.node_points, m.position)
        return _Assembled(m, system_matrix, self._constraint, m.mass_matrix[~m.prescribed], coefficients)

    def _operator(self, assembled: _Assembled) -> Operator[Parts]:
        return Operator(assembled.apply, partial(self._parts, assembled))

    def _parts(self, assembled: _Assembled) -> Parts:
        """Ingredients of a preconditioner of this matrix, which is kept as its origin."""
        m, system_matrix, masses = assembled.coupled, assembled.system_matrix, assembled.masses
        self._made_from[m.viscosity != 0.0] = m

        def reduced() -> sparse.csr_array:
            return self._reduced_matrix(system_matrix).filled(system_matrix, masses)

        return Parts(self._constraint, system_matrix, masses, m.points, assembled.coefficients, reduced)

    def _is_outdated(self, matrix: CoupledMatrix) -> bool:
        """Tell whether the factors at hand are of a step of another length or order, which serve badly."""
        origin = self._made_from.get(matrix.viscosity != 0.0)
        return origin is not None and abs(matrix.inertia - origin.inertia) > _OUTDATED * origin.inertia

    def _reduced_matrix(self, system_matrix: sparse.csr_array) -> ReducedMatrix:
        if self._reduced is None:
            self._reduced = ReducedMatrix(self._constraint, system_matrix)
        return self._reduced

    def _posed(self, system: CoupledSystem, assembled: _Assembled) -> _Posed:
        constraint, matrix = self._constraint, system.matrix
        given = np.concatenate([(system.prescribed - matrix.frame).ravel(), system.pressure_jump])
        load = np.concatenate([system.load.ravel(), np.zeros(self.numbering.vertices)])
        known = assembled.system_matrix @ given if given.any() else 0.0
        right_side = constraint.transposed @ (load - known)
        right_side[assembled.twists] += system.body_load[~matrix.prescribed].ravel()
        return _Posed(system, assembled, given, load, right_side)

    def _guess(self, system: CoupledSystem, twists: slice) -> FloatArray:
        constraint, pressure = self._constraint, system.pressure - system.pressure_jump
        if constraint.pressure_pin is not None:
            pressure = pressure - pressure[constraint.pressure_pin]
        guess = np.empty(constraint.unknowns)
        velocity = self.surfaces.frames.local_components(system.velocity)
        guess[constraint.free_columns] = np.concatenate([velocity.ravel(), pressure])[constraint.free_unknowns]
        guess[twists] = system.twist[~system.matrix.prescribed].ravel()
        return guess
