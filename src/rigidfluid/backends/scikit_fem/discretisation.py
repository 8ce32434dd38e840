"""Space and constraint of the present mesh topology, kept from step to step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.backends.scikit_fem import kernels
from rigidfluid.backends.scikit_fem.constraint import Constraint
from rigidfluid.backends.scikit_fem.space import TaylorHood
from rigidfluid.core.types import BoolArray, FloatArray, FluidProblem, Mesh


def mass_times(space: TaylorHood, points: FloatArray, field: FloatArray) -> FloatArray:
    """(field, v) for every nodal test function, (nodes, d)."""
    load: FloatArray = kernels.apply_mass(points, space.cell_vertices, space.cell_nodes, space.tables.mass, field)
    return load


def kinetic_energy(problem: FluidProblem, space: TaylorHood, points: FloatArray, velocity: FloatArray) -> float:
    """½ ρ ∫ |u|² [energy]; zero in Stokes flow, which has no inertia."""
    if not problem.inertia:
        return 0.0
    return 0.5 * problem.density * float(np.sum(velocity * mass_times(space, points, velocity)))


@dataclass(frozen=True)
class Discretisation:
    """The problem on one topology: what stays the same while the mesh only moves."""

    problem: FluidProblem
    space: TaylorHood
    constraint: Constraint

    def matrix_data(self, points: FloatArray, inertia: float, viscosity: float, advection: FloatArray) -> FloatArray:
        """Entries of the P2–P1 matrix K on vertices at ``points``; see :func:`kernels.assemble`."""
        space, t = self.space, self.space.tables
        data: FloatArray = kernels.assemble(
            points, space.cell_vertices, space.cell_nodes, space.slots, len(space.indices), inertia, viscosity,
            advection, t.value, t.gradient, t.weight, t.flat_gradient, t.flat_linear, t.flat_weight, t.mass,
        )  # fmt: skip
        return data

    def dissipation(self, points: FloatArray, velocity: FloatArray) -> float:
        """μ ∫ ½ |∇u + ∇uᵀ|² [energy/time]."""
        space, t = self.space, self.space.tables
        return self.problem.dynamic_viscosity * float(
            kernels.strain_square(
                points, space.cell_vertices, space.cell_nodes, t.flat_gradient, t.flat_weight, velocity
            )
        )


class Discretisations:
    """The latest topology's space and constraint; a topology is known by its array of cells."""

    def __init__(self, problem: FluidProblem) -> None:
        self._problem = problem
        self._space: TaylorHood | None = None
        self._latest: Discretisation | None = None

    def space(self, mesh: Mesh) -> TaylorHood:
        """The space on this mesh's topology."""
        if self._space is None or self._space.cells is not mesh.cells:
            self._space = TaylorHood(mesh.cells, len(mesh.points))
            self._latest = None
        return self._space

    def on(self, mesh: Mesh, controlled: BoolArray) -> Discretisation:
        """The discretisation on this mesh's topology, with these bodies controlled."""
        space = self.space(mesh)
        if self._latest is None or not np.array_equal(self._latest.constraint.controlled, controlled):
            constraint = Constraint(space, mesh, self._problem.conditions, controlled)
            self._latest = Discretisation(self._problem, space, constraint)
        return self._latest

    def forget(self) -> None:
        """Drop what depends on where the mesh was when it was made."""
        self._latest = None
