"""The equations in PETSc's distributed matrices."""

from __future__ import annotations

from functools import cache, partial

import numpy as np
from petsc4py import PETSc
from scipy.linalg import block_diag

from rigidfluid.backends.dolfinx.constraint import DistributedConstraint
from rigidfluid.backends.dolfinx.forms import Forms
from rigidfluid.backends.dolfinx.krylov import Krylov, LaggedLU
from rigidfluid.backends.dolfinx.reduced import Reduced
from rigidfluid.backends.dolfinx.schur import schur_data
from rigidfluid.backends.dolfinx.space import Space
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces, pressure_pin_vertex
from rigidfluid.taylor_hood.linear_solver.lagged_solver import Operator
from rigidfluid.taylor_hood.linear_solver.solvers import Solvers
from rigidfluid.taylor_hood.system.coefficients import coefficients_of
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution
from rigidfluid.taylor_hood.system.coupled_projection import CoupledProjection
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates


class Topology:
    """Data of one topology, whichever bodies are prescribed: the space, its forms and the matrix K."""

    def __init__(self, numbering: Numbering, mesh: Mesh) -> None:
        self.numbering = numbering
        self.space = Space(numbering, mesh)
        self.forms = Forms(self.space)
        self.matrix = self.forms.new_matrix()

    def clean(self) -> None:
        """Free what Python has let go of: with several processes petsc4py leaves that to a call that all make together.

        DOLFINx gives each mesh, and so K and what is made from it, a communicator of its own.
        """
        for communicator in (self.space.communicator, self.space.mesh.comm):
            PETSc.garbage_cleanup(communicator)

    def destroy(self) -> None:
        """Free all; nobody may have a use for this topology any more."""
        self.matrix.destroy()
        self.clean()


class PetscDiscretisation:
    """Pᵀ K P on MPI's processes, solved by a Krylov method; motions that are ``prescribed`` (N,) have a prescribed
    twist.

    The ``solvers`` are kept from topology to topology, and must have been told to forget the last one.
    """

    def __init__(
        self,
        problem: FluidProblem,
        topology: Topology,
        solvers: Solvers[Krylov],
        mesh: Mesh,
        prescribed: BoolArray,
    ) -> None:
        self.problem = problem
        self.numbering = topology.numbering
        self.surfaces = Surfaces(topology.numbering, mesh, problem.conditions, problem.carrier)
        self._topology, self._solvers = topology, solvers
        has_pin = self.surfaces.enclosed and isinstance(solvers.viscous, LaggedLU)
        pressure_pin = pressure_pin_vertex(self.surfaces, mesh) if has_pin else None
        self._constraint = DistributedConstraint(topology.space, self.surfaces, prescribed, pressure_pin)
        self._pressure_pin = pressure_pin

    @property
    def unknowns(self) -> int:
        return self._constraint.unknowns

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        self._topology.space.move(points)
        return self._topology.forms.mass_times(field)

    def projection(self, points: FloatArray, position: FloatArray) -> CoupledProjection:
        return CoupledProjection(self, points, position)

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        self._topology.space.move(points)
        return self._topology.forms.strain_square(velocity)

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        self._topology.space.move(points)
        return self._topology.forms.strain_rates(velocity)

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        self._topology.space.move(points)
        return self._topology.forms.stress_load(stress)

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        self._topology.space.move(points)
        return self._topology.forms.divergence_square(velocity, weight)

    def solve(self, system: CoupledSystem, tolerance: float) -> Solution:
        """Solve Pᵀ(K(P x + given - frame) - load) + (M x - L on the twists) = 0 from the guess onwards."""
        s, space, constraint = system, self._topology.space, self._constraint
        reduced, free = self._reduced(s.matrix), ~s.matrix.prescribed
        none = np.zeros(len(space.owned_vertices))
        given = np.concatenate([s.prescribed[space.owned_nodes].ravel(), none])
        given -= np.concatenate([np.tile(s.matrix.frame, len(space.owned_nodes)), none])
        load = np.concatenate([space.owned_sums(s.load), none])
        right_side = reduced.collect(load - reduced.times(given))
        right_side[constraint.twist_slice] += s.body_load[free].ravel()[: constraint.twists]
        guess = constraint.reduced(s.velocity, s.twist, s.pressure - self._pressure_at_pin(s.pressure))
        scale = max(self._solvers.viscous.norm(right_side), s.scale)
        guess *= scale > 0.0  # what nothing drives is exactly at rest, and no residual could be small beside zero
        residual = right_side - reduced.apply(guess)
        enough = tolerance * scale
        correction, _ = self._solvers.viscous.solve(_operator(reduced), residual, enough, again=s.again)
        return self._solution(s, reduced, guess + correction, given, load)

    def twist_response(self, matrix: CoupledMatrix, wrenches: FloatArray, tolerance: float) -> FloatArray:
        responses = self._impulse_response(self._reduced(matrix), matrix, wrenches, tolerance)
        found = np.zeros_like(wrenches)
        on_root = responses[self._constraint.twist_slice]
        found[~matrix.prescribed] = self.surfaces.ranks.bcast(on_root).reshape(-1, *wrenches.shape[1:])
        return found

    def velocity_response(self, matrix: CoupledMatrix, wrench: FloatArray, tolerance: float) -> FloatArray:
        reduced, space = self._reduced(matrix), self._topology.space
        response = self._impulse_response(reduced, matrix, wrench[:, :, None], tolerance)[:, 0]
        return space.velocities(reduced.expand(response)[: space.owned_nodes.size * space.numbering.dimension])

    def _impulse_response(
        self, reduced: Reduced, matrix: CoupledMatrix, wrenches: FloatArray, tolerance: float
    ) -> FloatArray:
        """This process' unknowns (columns, c) by ``wrenches`` (n, d+k, c) on the bodies alone."""
        solver = self._solvers.select(matrix.viscosity)
        constraint = self._constraint
        right_sides = np.zeros((constraint.columns, wrenches.shape[2]))
        on_bodies = wrenches[~matrix.prescribed].reshape(-1, wrenches.shape[2])
        right_sides[constraint.twist_slice] = on_bodies[: constraint.twists]
        return solver.solve_columns(_operator(reduced), right_sides, tolerance)

    def _reduced(self, matrix: CoupledMatrix) -> Reduced:
        """Reduced form of this matrix, valid until the next one is assembled in the place of K."""
        m, topology, constraint = matrix, self._topology, self._constraint
        topology.clean()
        topology.space.move(m.points)
        coefficients = coefficients_of(self.numbering, m)
        topology.forms.assemble(topology.matrix, coefficients)
        constraint_matrix = constraint.matrix(m.node_points, m.position)
        inertia = block_diag(*m.mass_matrix[~m.prescribed]) if constraint.twists else np.zeros((0, 0))
        schur = partial(schur_data, topology.space, topology.forms, self.surfaces, coefficients)
        return Reduced(constraint, topology.matrix, constraint_matrix, inertia, cache(schur))

    def _pressure_at_pin(self, pressure: FloatArray) -> float:
        """The guess's ``pressure`` at the pressure pin, where it is zero; 0 for solvers that need no such vertex."""
        own = 0.0 if self._pressure_pin is None else float(pressure[self._pressure_pin])
        return float(self.surfaces.ranks.sum(own))

    def _solution(
        self, system: CoupledSystem, reduced: Reduced, x: FloatArray, given: FloatArray, load: FloatArray
    ) -> Solution:
        """The solution of which x (columns,) is the reduced one; ``given`` is seen from the container."""
        space, constraint, ranks = self._topology.space, self._constraint, self.surfaces.ranks
        everything = reduced.expand(x) + given
        size = space.owned_nodes.size * space.numbering.dimension
        reaction = np.zeros_like(system.prescribed)
        reaction[space.owned_nodes] = (reduced.times(everything) - load)[:size].reshape(-1, system.prescribed.shape[1])
        twist = system.twist.copy()
        free = ~system.matrix.prescribed
        twist[free] = ranks.bcast(x[constraint.twist_slice]).reshape(-1, twist.shape[1])
        velocity = space.velocities(everything[:size]) + system.matrix.frame
        return Solution(velocity, space.pressures(everything[size:]), twist, reaction)


def _operator(reduced: Reduced) -> Operator[Reduced]:
    return Operator(reduced.apply, lambda: reduced)
