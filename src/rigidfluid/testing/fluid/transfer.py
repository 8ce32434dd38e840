"""States that come from elsewhere: from another mesh, or from bodies set in motion by an impact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.testing.fluid.base import FluidContract, stirring_shift
from rigidfluid.testing.fluid.boxes import (
    ball_moments,
    balls_pose,
    box,
    box_with_balls,
    carried,
    finer_box_with_balls,
    quadrature,
    renumbered,
    samples,
)
from rigidfluid.testing.fluid.exact import DENSITY, LinearFlow, enclosed, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, components, figures

INSTANT = 1e-6
"""A step in which viscosity does next to nothing [time]."""


class TransferContract(FluidContract):
    """Both time levels arrive, without divergence and with rigid bodies, and the energy lost is told."""

    def test_a_linear_flow_is_kept(self, dimension: int) -> None:
        """On a mesh of other cells, and so are the steps after it: u = (1 + t)(A x + b) needs both time levels."""
        exact = replace(LinearFlow.shear(dimension), factor=lambda time: 1.0 + time, rate=lambda _: 1.0)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), box(dimension, 3)).after(None)
        flow = self._transferred(flow.after(0.1).after(0.1), box(dimension, 4))
        points = samples(dimension)
        for _ in range(2):
            velocity, pressure = flow.probe(points)
            self.assert_close(velocity, exact.velocity(flow.time, points), scale=10.0)
            self.assert_close(pressure, exact.pressure(flow.time, points), scale=100.0)
            flow = flow.after(0.05)

    def test_another_numbering_changes_nothing(self, dimension: int) -> None:
        """The same mesh with its vertices and cells in another order, in motion with a prescribed and a free body."""
        flow = self.stirred(dimension, steps=3)
        shift = stirring_shift(flow.time)[:, :dimension]
        there = self._transferred(flow, renumbered(box_with_balls(dimension)), shift)
        points = samples(dimension)
        for _ in range(2):
            flow, there = self.stir(flow), self.stir(there)
            for name, found in figures(there.advance).items():
                expected = figures(flow.advance)[name]
                self.assert_close(found, expected, scale=100.0 * float(np.abs(expected).max()))
            self.assert_close(there.probe(points)[0], flow.probe(points)[0], scale=100.0)

    def test_no_blow_of_pressure_on_another_mesh(self, dimension: int) -> None:
        """Smaller facets, rigid as well; and a short step has forces like the one before: there is no divergence."""
        flow = self.stirred(dimension, steps=3)
        before = np.abs(components(flow.advance.hydrodynamic_wrench)).max()
        finer = finer_box_with_balls(dimension, stirring_shift(flow.time)[:, :dimension])
        there, twist = self._transferred(flow, finer), components(flow.twist)
        self.assert_rigid(there, twist, finer)
        there = replace(there, past=None, bodies=replace(there.bodies, prescribed=np.ones(2, dtype=bool)))
        wrench = components(there.after(INSTANT, twist=twist).advance.hydrodynamic_wrench)
        assert np.abs(wrench).max() < 10.0 * before

    def test_the_energy_lost_is_told(self, dimension: int) -> None:
        """The loss is the difference of ½ ρ ∫ |u|² on the two meshes, for waves that the new one cannot resolve."""
        old, new = box(dimension, 4), box(dimension, 2)
        flow = self.empty(enclosed(dimension, _nothing, _short_waves), old).after(0.1)
        before = _energy(flow, old)
        self.assert_close(flow.advance.kinetic_energy, before, scale=before)
        mesh = self.make_mesh(new)
        fluid, lost = flow.backend.transfer(flow.fluid, flow.mesh, mesh)
        after = _energy(replace(flow, fluid=fluid, mesh=mesh), new)
        assert before - after > 0.1 * before
        self.assert_close(lost, before - after, scale=before)

    def test_bodies_at_rest_leave_the_fluid_at_rest(self, dimension: int) -> None:
        """``initial`` without a motion: no velocity, no energy."""
        pose = balls_pose(dimension)
        flow = self.with_balls(problem(dimension, bodies=2))
        assert not flow.probe(samples(dimension))[0].any()
        _, energy = flow.backend.initial(flow.mesh, pose, flow.twist)
        assert energy == 0.0

    def test_bodies_set_in_motion_take_fluid_along(self, dimension: int) -> None:
        """``initial``: rigid on the bodies, energy ½ ρ ∫ |u|², and no burst of pressure in the first step."""
        twist = np.random.default_rng(2).normal(size=(2, 3 if dimension == 2 else 6))
        pose = balls_pose(dimension)
        flow = self.with_balls(problem(dimension, bodies=2), twist=twist)
        self.assert_rigid(flow, twist, box_with_balls(dimension))
        _, energy = flow.backend.initial(flow.mesh, pose, flow.twist)
        expected = _energy(flow, box_with_balls(dimension))
        self.assert_close(energy, expected, scale=expected)
        after = flow.after(INSTANT, twist=twist)
        impulse = INSTANT * np.abs(components(after.advance.hydrodynamic_wrench)).max()
        assert impulse < 0.01 * expected, (impulse, expected)

    @pytest.mark.parametrize("free", [False, True], ids=["prescribed", "free"])
    def test_faces_set_in_motion_take_all_along(self, dimension: int, free: bool) -> None:
        """``struck``, if the backend has it: all faces drift from now on, and so do fluid and bodies of its density."""
        drift, whole = np.array([0.3, 0.2, -0.4])[:dimension], box_with_balls(dimension)
        moments = [ball_moments(whole, ball) for ball in range(2)]
        pose = Pose(np.array([centroid for _, centroid in moments]), balls_pose(dimension).orientation)
        mass = DENSITY * np.array([volume for volume, _ in moments])
        bodies = Bodies(mass, Bodies.uniform(pose).inertia, np.full(2, not free))
        twist = np.column_stack([[drift, drift], np.zeros((2, 2 * dimension - 3))])
        drifting = enclosed(dimension, lambda _, points: np.tile(drift, (len(points), 1)), bodies=2)
        flow = self.with_balls(drifting, bodies, pose)
        step = flow.step_after(1e-4, twist=None if free else twist)
        struck = flow.backend.struck(flow.mesh, pose, flow.twist, step)
        if struck is None:
            pytest.skip("the backend leaves that to the first step")
        fluid, energy, motions = struck
        there = replace(flow, fluid=fluid, twist=motions)
        self.assert_close(components(motions), twist, scale=10.0)
        self.assert_close(there.probe(samples(dimension))[0], np.tile(drift, (len(samples(dimension)), 1)), scale=10.0)
        expected = _energy(there, whole)
        self.assert_close(energy, expected, scale=expected)

    def _transferred(self, flow: Flow, whole: Mesh, shift: FloatArray | None = None) -> Flow:
        """The flow on another mesh, one with balls once these are displaced by ``shift`` (2, d)."""
        reference = self.make_mesh(whole)
        mesh = reference if shift is None else replace(reference, points=carried(reference.points, shift))
        fluid, _ = flow.backend.transfer(flow.fluid, flow.mesh, mesh)
        return replace(flow, fluid=fluid, mesh=mesh, reference=reference)


def _nothing(time: float, points: FloatArray) -> FloatArray:
    """No velocity."""
    return np.zeros_like(points)


def _short_waves(time: float, points: FloatArray) -> FloatArray:
    """A force along x that is zero at all nodes of a box of two cells along each edge."""
    return np.asarray(np.sin(4.0 * np.pi * points[:, 1:2]) * np.eye(points.shape[1])[0])


def _energy(flow: Flow, whole: Mesh) -> float:
    """½ ρ ∫ |u|² by probing."""
    points, weights = quadrature(whole)
    return 0.5 * DENSITY * float(weights @ np.sum(flow.probe(points)[0] ** 2, axis=1))
