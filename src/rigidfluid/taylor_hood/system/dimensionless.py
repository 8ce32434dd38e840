"""Solves a step in units of its own: what a residual's norm weighs does not depend on those of the scene."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.mesh_quality import cell_volumes
from rigidfluid.core.model.types import Mesh
from rigidfluid.taylor_hood.elements.numbering import Numbering
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix, CoupledSystem, Solution
from rigidfluid.taylor_hood.system.discretisation import Discretisation, Linearisable, Projection
from rigidfluid.taylor_hood.system.local_viscosity import StrainRates

_DIVERGENCE = 1.0 / 32.0
"""w: what a residual of divergence weighs relative to one of momentum. With 1 steps in 3D take a sixth more iterations,
and bodies move by 1e-9 of their way from where they do now."""


class Dimensionless:
    """A discretisation that is given lengths over a cell's, h, and forces over Z = w (ρ d₀ hᵈ + μ hᵈ⁻²).

    All unknowns are then velocities, u, p hᵈ⁻¹/Z and ω h, and so are all residuals, those of divergence by w the less.

    Parameters
    ----------
    inner : Discretisation
        The equations, in whatever units they are given.
    mesh : Mesh
        A mesh of its topology, from which h is (total volume / cells)^(1/d).
    """

    def __init__(self, inner: Discretisation, mesh: Mesh) -> None:
        self.inner = inner
        self.problem: FluidProblem = inner.problem
        self.numbering: Numbering = inner.numbering
        self.surfaces: Surfaces = inner.surfaces
        volumes = np.abs(cell_volumes(mesh.points, mesh.cells))
        whole, cells = self.surfaces.ranks.sum(np.array([volumes.sum(), len(volumes)]))
        self._length = float(whole / cells) ** (1.0 / mesh.points.shape[1])
        self._latest: dict[bool, tuple[CoupledMatrix, _Scaled]] = {}

    @property
    def unknowns(self) -> int:
        return self.inner.unknowns

    def mass_times(self, points: FloatArray, field: FloatArray) -> FloatArray:
        return self.inner.mass_times(points, field)

    def strain_square(self, points: FloatArray, velocity: FloatArray) -> float:
        return self.inner.strain_square(points, velocity)

    def strain_rates(self, points: FloatArray, velocity: FloatArray) -> StrainRates:
        return self.inner.strain_rates(points, velocity)

    def stress_load(self, points: FloatArray, stress: FloatArray) -> FloatArray:
        return self.inner.stress_load(points, stress)

    def divergence_square(self, points: FloatArray, velocity: FloatArray, weight: FloatArray) -> float:
        return self.inner.divergence_square(points, velocity, weight)

    def projection(self, points: FloatArray, position: FloatArray) -> Projection:
        volume = self._length ** points.shape[1]
        return _ScaledProjection(self.inner.projection(points / self._length, position / self._length), volume)

    def solve(self, system: CoupledSystem, tolerance: float) -> Solution:
        scaled = self._scaled(system.matrix)
        return scaled.solution(self.inner.solve(scaled.system(system), tolerance), system)

    def twin(self, problem: FluidProblem) -> Dimensionless:
        """The same discretisation, in the same units, of a ``problem`` with other values."""
        twin = copy(self)
        twin.problem, twin.surfaces = problem, self.surfaces.under(problem.conditions)
        return twin

    def neighbours(
        self, system: CoupledSystem, pairs: Sequence[tuple[CoupledSystem, CoupledSystem]], tolerance: float
    ) -> list[tuple[Solution, Solution]]:
        """Solutions of ``pairs`` of systems that differ little from a solved one, see `SparseDiscretisation`, all in
        the units of that one."""
        assert isinstance(self.inner, Linearisable)
        scaled = self._scaled(system.matrix)

        def in_its_units(each: CoupledSystem) -> CoupledSystem:
            return _Scaled(each.matrix, self.numbering, self._length, scaled.force).system(each)

        asked = [(in_its_units(plus), in_its_units(minus)) for plus, minus in pairs]
        found = self.inner.neighbours(scaled.system(system), asked, tolerance)
        return [
            (scaled.solution(plus, pair[0]), scaled.solution(minus, pair[1]))
            for (plus, minus), pair in zip(found, pairs, strict=True)
        ]

    def twist_response(self, matrix: CoupledMatrix, wrenches: FloatArray, tolerance: float) -> FloatArray:
        scaled = self._scaled(matrix)
        each = scaled.twists[:, None]
        return self.inner.twist_response(scaled.matrix, wrenches * each / scaled.force, tolerance) * each

    def velocity_response(self, matrix: CoupledMatrix, wrench: FloatArray, tolerance: float) -> FloatArray:
        scaled = self._scaled(matrix)
        return self.inner.velocity_response(scaled.matrix, wrench * scaled.twists / scaled.force, tolerance)

    def _scaled(self, matrix: CoupledMatrix) -> _Scaled:
        """The latest of a step and the latest of its masses are kept: who solves knows a matrix by its identity."""
        viscous = matrix.viscosity != 0.0
        if viscous not in self._latest or self._latest[viscous][0] is not matrix:
            force = _unit_force(matrix, self._length)
            self._latest[viscous] = matrix, _Scaled(matrix, self.numbering, self._length, force)
        return self._latest[viscous][1]


class _Scaled:
    """A ``matrix`` without dimensions; ``force`` Z [force·time/length], ``pressure`` Z/hᵈ⁻¹, and ``twists`` (d+k,), 1
    and 1/h."""

    def __init__(self, m: CoupledMatrix, numbering: Numbering, length: float, force: float) -> None:
        d = m.points.shape[1]
        self.force = force
        self.pressure = self.force / length ** (d - 1)
        self.twists = np.where(np.arange(m.mass_matrix.shape[1]) < d, 1.0, 1.0 / length)
        self.matrix = CoupledMatrix(
            points=m.points / length,
            node_points=numbering.node_points(m.points / length),  # what is recalled makes them so, to the last bit
            inertia=m.inertia * length**d / self.force,
            viscosity=m.viscosity * length ** (d - 2) / self.force,
            advection=m.advection / self.pressure,
            flow=m.flow / self.pressure,
            position=m.position / length,
            mass_matrix=m.mass_matrix * self.twists[:, None] * self.twists / self.force,
            prescribed=m.prescribed,
            frame=m.frame,
            local=m.local,
        )

    def system(self, s: CoupledSystem) -> CoupledSystem:
        return replace(
            s,
            matrix=self.matrix,
            load=s.load / self.force,
            body_load=s.body_load * self.twists / self.force,
            pressure=s.pressure / self.pressure,
            twist=s.twist / self.twists,
            pressure_jump=s.pressure_jump / self.pressure,
            scale=s.scale / self.force,
        )

    def solution(self, found: Solution, s: CoupledSystem) -> Solution:
        """The solution of a system ``s`` in its units."""
        twist = np.where(s.matrix.prescribed[:, None], s.twist, found.twist * self.twists)
        return Solution(
            velocity=found.velocity,
            pressure=found.pressure * self.pressure,
            twist=twist,
            reaction=found.reaction * self.force,
            jump_load=None if found.jump_load is None else found.jump_load * self.force,
        )


def _unit_force(matrix: CoupledMatrix, length: float) -> float:
    """Z of a matrix [force·time/length]."""
    d = matrix.points.shape[1]
    return float(_DIVERGENCE * (matrix.inertia * length**d + matrix.viscosity * length ** (d - 2)))


@dataclass(frozen=True)
class _ScaledProjection:
    """A projection in units of length of its own, of which a ``volume`` is one."""

    inner: Projection
    volume: float

    def nearest(
        self, velocity: FloatArray, tolerance: float, guess: FloatArray, prescribed: FloatArray | None = None
    ) -> FloatArray:
        return self.inner.nearest(velocity, tolerance, guess, prescribed)

    def product(self, first: FloatArray, second: FloatArray) -> float:
        return self.inner.product(first, second) * self.volume
