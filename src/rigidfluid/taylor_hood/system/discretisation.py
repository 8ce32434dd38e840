"""Contract of a backend of Taylor–Hood elements: the equations on one topology, assembled and solved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates


class Projection(Protocol):
    """Projection onto velocities without divergence on one geometry, with values prescribed on bodies and
    faces."""

    def nearest(
        self, velocity: FloatArray, tolerance: float, guess: FloatArray, prescribed: FloatArray | None = None
    ) -> FloatArray:
        """Velocity (nodes, d) without divergence nearest to ``velocity`` (nodes, d) in L², from a ``guess`` onwards.

        It equals ``prescribed`` (nodes, d), by default ``velocity`` too, on bodies and prescribed faces. Its relative
        residual is ``tolerance``; raises StepRejected.
        """

    def product(self, first: FloatArray, second: FloatArray) -> float:
        """(first, second) of velocities (nodes, d)."""


class Discretisation(Protocol):
    """P2–P1 on one topology, or on one process' part of it; ``unknowns`` of all."""

    problem: FluidProblem
    numbering: Numbering
    surfaces: Surfaces

    @property
    def unknowns(self) -> int:
        """Number of unknowns that a step solves for."""

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        """(field, v) for every nodal test function over this process' cells, (nodes, d)."""

    def projection(self, points: FloatArray, position: FloatArray) -> Projection:
        """Projection on the geometry ``points`` with motions at ``position`` (N, d), all of them prescribed."""

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        """∫ ½ (∇u + ∇uᵀ):(∇u + ∇uᵀ) over this process' cells."""

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        """∇u + ∇uᵀ at the points by which viscous stress is integrated over this process' cells."""

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        """(stress, ∇v) for every nodal test function over this process' cells, (nodes, d), of ``stress`` (N, d, d),
        symmetric, at those points."""

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        """∫ w (∇·u)² over this process' cells, ``weight`` w (M,) of each."""

    def solve(self, system: CoupledSystem, tolerance: float) -> Solution:
        """Solve to a residual of ``tolerance`` times the norm of the right side; raises StepRejected."""

    def twist_response(self, matrix: CoupledMatrix, wrenches: FloatArray, tolerance: float) -> FloatArray:
        """Twists (n, d+k, c) that each of c ``wrenches`` (n, d+k, c) on the bodies gives by itself.

        Residuals are ``tolerance`` times each column's norm; raises StepRejected.
        """

    def velocity_response(self, matrix: CoupledMatrix, wrench: FloatArray, tolerance: float) -> FloatArray:
        """The velocity (nodes, d) that a ``wrench`` (n, d+k) on the bodies gives by itself."""


@runtime_checkable
class Linearisable(Protocol):
    """Discretisation that linearises a step about its solution."""

    def neighbours(
        self, system: CoupledSystem, pairs: Sequence[tuple[CoupledSystem, CoupledSystem]], tolerance: float
    ) -> list[tuple[Solution, Solution]]:
        """Solutions, to first order, of ``pairs`` of systems that differ little from one whose guess solves it; raises
        StepRejected."""


@runtime_checkable
class TellsResidual(Protocol):
    """Discretisation that tells by how much a guess misses the fluid's equations."""

    def residual(self, system: CoupledSystem) -> FloatArray:
        """K times the guess less the load, for all of the fluid's test functions (unknowns of K,)."""


def kinetic_energy(discretisation: Discretisation, points: FloatArray, velocity: FloatArray) -> float:
    """½ ρ ∫ |u|² [energy]; zero in Stokes flow, which has no inertia."""
    problem, ranks = discretisation.problem, discretisation.surfaces.ranks
    if not problem.inertia:
        return 0.0
    return 0.5 * problem.density * float(ranks.sum(np.sum(velocity * discretisation.mass_times(points, velocity))))


def dissipation(discretisation: Discretisation, points: FloatArray, velocity: FloatArray) -> float:
    """∫ μ ½ |∇u + ∇uᵀ|² [energy/time]."""
    if not isinstance(discretisation.problem.material, Newtonian):
        return stress_power(discretisation, points, velocity, velocity)
    rate = discretisation.surfaces.ranks.sum(discretisation.strain_square(points, velocity))
    return discretisation.problem.material.dynamic_viscosity * float(rate)


def stress_power(discretisation: Discretisation, points: FloatArray, velocity: FloatArray, other: FloatArray) -> float:
    """∫ μ ½ (∇u + ∇uᵀ):(∇v + ∇vᵀ) [energy/time], of the viscous stress of a ``velocity`` u in an ``other`` v."""
    material, ranks = discretisation.problem.material, discretisation.surfaces.ranks
    if not isinstance(material, Newtonian):
        strain, others = (discretisation.strain_rates(points, each) for each in (velocity, other))
        viscosity = strain.weight * material.viscosity(strain.shear_rate)
        return float(ranks.sum(0.5 * np.einsum("n,nac,nac", viscosity, strain.tensor, others.tensor)))
    mean, half = 0.5 * (velocity + other), 0.5 * (velocity - other)
    return dissipation(discretisation, points, mean) - dissipation(discretisation, points, half)
