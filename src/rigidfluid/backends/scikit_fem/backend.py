"""Fluid backend "scikit-fem": ALE Navier–Stokes or Stokes by Taylor–Hood P2–P1, bodies coupled monolithically."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field

from rigidfluid.core.interfaces import FluidBackend, PartOptions
from rigidfluid.core.types import (
    Advance,
    BoolArray,
    Fields,
    FloatArray,
    FluidProblem,
    FluidState,
    Mesh,
    Pose,
    Step,
    Twist,
)


class ScikitFemOptions(PartOptions):
    """Keys of ``[fluid]`` that this backend reads."""

    tolerance: float = Field(1e-9, ge=1e-13, lt=1, description="Relative residual of each step's linear system [1]")


class ScikitFem(FluidBackend):
    """P2–P1 finite elements on triangles or tetrahedra: spaces by scikit-fem, loops compiled by numba.

    Each step solves  ρ(d₀uⁿ⁺¹ + d₁uⁿ + d₂uⁿ⁻¹, v) + ρ(((u* - w)·∇)uⁿ⁺¹, v) + μ(∇u + ∇uᵀ, ∇v) - (p, ∇·v) = (f, v),
    (∇·u, q) = 0  on the new mesh, with u* extrapolated and w the mesh velocity by the same derivative weights, for
    velocities that move rigidly with each body (Maury 1999, doi:10.1006/jcph.1999.6342), plus the bodies' own inertia.
    """

    name: ClassVar[str] = "scikit-fem"
    requires: ClassVar[dict[str, str]] = {"skfem": "scikit-fem", "numba": "numba"}
    Options: ClassVar[type[PartOptions]] = ScikitFemOptions

    options: ScikitFemOptions
    problem: FluidProblem

    def __init__(self, options: PartOptions, problem: FluidProblem | None) -> None:
        super().__init__(options, problem)
        from rigidfluid.backends.scikit_fem.discretisation import Discretisations
        from rigidfluid.backends.scikit_fem.stale_solver import StaleSolver

        self._discretisations = Discretisations(self.problem)
        self._solver = StaleSolver()

    def initial(self, mesh: Mesh | None, pose: Pose, twist: Twist) -> tuple[FluidState, float]:
        from rigidfluid.backends.scikit_fem.transfer import initial

        everything = np.ones(self.problem.bodies, dtype=bool)
        return initial(self._discretisations.on(_given(mesh), everything), _given(mesh), pose, twist)

    def advance(self, fluid: FluidState, mesh: Mesh | None, step: Step) -> Advance:
        from rigidfluid.backends.scikit_fem.advance import advance

        discretisation = self._discretisations.on(_given(mesh), step.controlled)
        return advance(discretisation, self._solver, self.options.tolerance, fluid, _given(mesh), step)

    def transfer(self, fluid: FluidState, old: Mesh, new: Mesh) -> tuple[FluidState, float]:
        from rigidfluid.backends.scikit_fem.transfer import transfer

        everything = np.ones(self.problem.bodies, dtype=bool)
        source = self._discretisations.space(old)
        self._solver.forget()
        target = self._discretisations.on(new, everything)
        return transfer(source, target, fluid, old, new)

    def fields(self, fluid: FluidState, mesh: Mesh) -> Fields:
        space = self._discretisations.space(mesh)
        return Fields(
            space.node_points(mesh.points), space.cell_nodes, fluid["velocity"], space.node_points(fluid["pressure"])
        )

    def probe(self, fluid: FluidState, mesh: Mesh, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        from rigidfluid.backends.scikit_fem.location import locate, quadratic_basis

        space = self._discretisations.space(mesh)
        cell, coordinates = locate(mesh.points, space.cell_vertices, points)
        velocity = np.einsum("ni,nid->nd", quadratic_basis(coordinates), fluid["velocity"][space.cell_nodes[cell]])
        return velocity, np.einsum("ni,ni->n", coordinates, fluid["pressure"][space.cell_vertices[cell]])

    def unknowns(self, mesh: Mesh | None, controlled: BoolArray) -> int:
        return int(self._discretisations.on(_given(mesh), controlled).constraint.unknowns)

    def forget(self) -> None:
        self._solver.forget()
        self._discretisations.forget()


def _given(mesh: Mesh | None) -> Mesh:
    assert mesh is not None, "the scikit-fem backend declares needs_mesh"
    return mesh
