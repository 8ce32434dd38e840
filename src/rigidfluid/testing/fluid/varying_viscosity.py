"""Generalised Newtonian fluids, for backends that solve for them."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.wrenches import flat
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import balls_pose, box, samples
from rigidfluid.testing.fluid.curved import CENTRE, ball_in_a_box
from rigidfluid.testing.fluid.exact import VISCOSITY, LinearFlow, enclosed, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, components, size


class Thinning(GeneralisedNewtonian):
    """μ = μ₀ (1 - s + s/√(1 + γ̇²)) with the ``share`` s."""

    name: ClassVar[str] = "thinning"

    def __init__(self, dimension: int, share: float = 0.8) -> None:
        super().__init__(PartOptions(), dimension)
        self.dynamic_viscosity, self._share = VISCOSITY, share

    def viscosity(self, shear_rate: FloatArray) -> FloatArray:
        """μ, (N,) [mass·length^(2-d)/time]."""
        thinned = 1.0 - self._share + self._share / np.sqrt(1.0 + shear_rate**2)
        return np.asarray(VISCOSITY * thinned)


class VaryingViscosityContract(FluidContract):
    """Flows of a fluid that thins with the shear rate."""

    @pytest.fixture
    def solved(self) -> None:
        """Skip where the backend solves for Newtonian fluids alone."""
        if not any(issubclass(GeneralisedNewtonian, each) for each in self.backend.materials):
            pytest.skip("this backend solves for Newtonian fluids alone")

    @pytest.mark.usefixtures("solved")
    @pytest.mark.parametrize("inertia", [False, True], ids=["stokes", "navier-stokes"])
    def test_a_linear_flow_has_the_viscosity_of_its_shear_rate(self, dimension: int, inertia: bool) -> None:
        """u = A x + b has one shear rate γ̇ everywhere, and dissipates μ(γ̇) γ̇²."""
        exact, material = LinearFlow.steady(dimension), Thinning(dimension)
        posed = enclosed(dimension, exact.velocity, exact.source, inertia=inertia)
        if not inertia:
            posed = replace(posed, source=lambda _, points: np.tile(exact.slope, (len(points), 1)))
        flow = self.empty(replace(posed, material=material), box(dimension, 3)).after(None).after(0.1)
        points = samples(dimension)
        velocity, pressure = flow.probe(points)
        self.assert_close(velocity, exact.velocity(1.0, points), scale=10.0)
        self.assert_close(pressure, exact.pressure(1.0, points), scale=10.0)
        rate = np.sqrt(0.5) * np.linalg.norm(exact.gradient + exact.gradient.T)
        dissipated = float(material.viscosity(np.array([rate]))[0]) * rate**2
        assert dissipated < 0.8 * VISCOSITY * rate**2
        self.assert_close(flow.advance.dissipation, dissipated, scale=10.0)

    @pytest.mark.usefixtures("solved")
    def test_a_viscosity_that_varies_by_nothing_is_a_newtonian_one(self, dimension: int) -> None:
        """In a stirred flow: the same twists, responses and powers."""
        bodies = replace(Bodies.uniform(balls_pose(dimension), mass=0.05), prescribed=np.array([True, False]))
        found = []
        for material in (None, Thinning(dimension, share=0.0)):
            posed = problem(dimension, bodies=2)
            flow = self.with_balls(posed if material is None else replace(posed, material=material), bodies)
            for _ in range(2):
                flow = self.stir(flow)
            given = self.stirring(flow)
            impulses = np.zeros((1, 2, size(balls_pose(dimension))))
            impulses[0, 1, 0] = 0.01
            response = flow.backend.response(flow.fluid, flow.mesh, given, impulses)
            powers = [flow.advance.dissipation, flow.advance.kinetic_energy]
            found.append((components(flow.twist), response.viscous, flat(flow.advance.hydrodynamic_wrench), powers))
        for mine, theirs in zip(*found, strict=True):
            self.assert_close(mine, theirs, scale=100.0 * float(np.abs(theirs).max()))

    @pytest.mark.usefixtures("solved")
    def test_what_bodies_give_is_dissipated(self, dimension: int) -> None:
        """Without inertia, by two balls that move in a box at rest; less than in a fluid that does not thin."""
        pose = balls_pose(dimension)
        twist = np.linspace(-1.0, 2.0, 2 * size(pose)).reshape(2, -1)
        dissipated = []
        for share in (0.8, 0.0):
            posed: FluidProblem = problem(dimension, bodies=2, inertia=False)
            posed = replace(posed, material=Thinning(dimension, share))
            flow = self.with_balls(posed, Bodies.uniform(pose)).after(None, twist=twist)
            given = -float(np.sum(components(flow.advance.hydrodynamic_wrench) * twist))
            lost = flow.advance.dissipation + flow.advance.grad_div
            self.assert_close(lost, given, scale=10.0 * given)
            dissipated.append(given)
        assert dissipated[0] < 0.8 * dissipated[1]

    @pytest.mark.usefixtures("solved")
    def test_what_a_ball_gives_in_curved_cells_is_dissipated(self, dimension: int) -> None:
        """Without inertia, as it turns and moves in a box at rest."""
        if not self.backend.curved_cells:
            pytest.skip(f"{self.backend.name} takes straight cells alone")
        pose = Pose(np.full((1, dimension), CENTRE), np.eye(1, 1 if dimension == 2 else 4))
        posed: FluidProblem = replace(problem(dimension, bodies=1, inertia=False), material=Thinning(dimension))
        mesh = self.make_mesh(ball_in_a_box(dimension, 2))
        twist = np.linspace(-1.0, 2.0, size(pose)).reshape(1, -1)
        flow = Flow.start(self.make_backend(posed), mesh, pose, Bodies.uniform(pose)).after(None, twist=twist)
        given = -float(np.sum(components(flow.advance.hydrodynamic_wrench) * twist))
        self.assert_close(flow.advance.dissipation + flow.advance.grad_div, given, scale=10.0 * given)
