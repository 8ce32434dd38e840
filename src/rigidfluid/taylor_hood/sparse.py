"""The equations in SciPy's sparse matrices, in one process."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy import sparse

from rigidfluid.core.types import BoolArray, FloatArray, FluidProblem, Mesh
from rigidfluid.taylor_hood.constraint import Constraint
from rigidfluid.taylor_hood.coupled import CoupledSystem, Solution
from rigidfluid.taylor_hood.numbering import Numbering
from rigidfluid.taylor_hood.stale_solver import StaleSolver
from rigidfluid.taylor_hood.surfaces import Surfaces


class Assembly(Protocol):
    """Integrals over the cells of one topology, in the numbers of ``numbering``."""

    numbering: Numbering

    def matrix(self, points: FloatArray, inertia: float, viscosity: float, advection: FloatArray) -> sparse.csr_array:
        """K: inertia (u, v) + (a·∇u, v) + viscosity (∇u + ∇uᵀ, ∇v) - (p, ∇·v) - (∇·u, q).

        ``advection`` a (nodes, d) already holds the density.
        """

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function, (nodes, d)."""

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ)."""


class SparseDiscretisation:
    """Pᵀ K P, solved by factors of an earlier step's matrix.

    Parameters
    ----------
    problem : FluidProblem
        Equations and boundary conditions.
    assembly : Assembly
        The integrals.
    solver : StaleSolver
        Kept from topology to topology; it must have been told to forget the last one.
    mesh : Mesh
        The topology.
    controlled : (n,) bool
        Bodies whose twist is given.
    """

    def __init__(
        self, problem: FluidProblem, assembly: Assembly, solver: StaleSolver, mesh: Mesh, controlled: BoolArray
    ) -> None:
        self.problem = problem
        self.numbering = assembly.numbering
        self.surfaces = Surfaces(assembly.numbering, mesh, problem.conditions, problem.bodies)
        self._constraint = Constraint(self.surfaces, mesh, controlled)
        self._assembly = assembly
        self._solver = solver

    @property
    def unknowns(self) -> int:
        return int(self._constraint.unknowns)

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        return self._assembly.mass_times(points, field)

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        return self._assembly.strain_square(points, velocity)

    def solve(self, system: CoupledSystem, tolerance: float) -> Solution:
        """Solve Pᵀ(K(P x + given) - load) + (M x - L on the twists) = 0 from the guess onwards."""
        s, constraint = system, self._constraint
        stiffness = self._assembly.matrix(s.points, s.inertia, s.viscosity, s.advection)
        constraint.place(s.node_points, s.position)
        zero = np.zeros(self.numbering.vertices)
        given, load = np.concatenate([s.given.ravel(), zero]), np.concatenate([s.load.ravel(), zero])
        free = ~s.controlled
        twists = slice(constraint.twist_start, constraint.twist_start + s.body_load[free].size)
        inertia = sparse.block_diag([*s.mass_matrix[free], sparse.csr_array((0, 0))], format="csr")

        def apply(x: FloatArray) -> FloatArray:
            result: FloatArray = constraint.transposed @ (stiffness @ (constraint.operator @ x))
            result[twists] += inertia @ x[twists]
            return result

        def matrix() -> sparse.csr_array:
            entries = inertia.tocoo()
            place = (entries.row + twists.start, entries.col + twists.start)
            embedded = sparse.coo_array((entries.data, place), shape=(constraint.unknowns,) * 2)
            return sparse.csr_array(constraint.transposed @ stiffness @ constraint.operator + embedded)

        right_side = constraint.transposed @ (load - stiffness @ given)
        right_side[twists] += s.body_load[free].ravel()
        guess = self._guess(s, twists)
        scale = float(np.linalg.norm(right_side))
        correction, _ = self._solver.solve(apply, matrix, right_side - apply(guess), tolerance * scale)
        reduced = guess + correction
        everything = constraint.operator @ reduced + given
        twist = s.twist.copy()
        twist[free] = reduced[twists].reshape(-1, twist.shape[1])
        velocity, pressure = np.split(everything, [s.given.size])
        reaction = (stiffness @ everything - load)[: s.given.size]
        return Solution(velocity.reshape(s.given.shape), pressure, twist, reaction.reshape(s.given.shape))

    def _guess(self, system: CoupledSystem, twists: slice) -> FloatArray:
        constraint, pressure = self._constraint, system.pressure
        if constraint.pinned is not None:
            pressure = pressure - pressure[constraint.pinned]
        guess = np.empty(constraint.unknowns)
        guess[constraint.free_columns] = np.concatenate([system.velocity.ravel(), pressure])[constraint.free_unknowns]
        guess[twists] = system.twist[~system.controlled].ravel()
        return guess
