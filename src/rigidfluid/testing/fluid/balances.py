"""Forces, momentum and energies: what the fluid gives, takes and keeps adds up."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from rigidfluid.core.fluid.conditions import NoSlip, PrescribedPressure, Slip
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import cross, moment
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.types import Pose
from rigidfluid.testing.fluid.base import FluidContract
from rigidfluid.testing.fluid.boxes import (
    ball_moments,
    balls_pose,
    box,
    box_with_balls,
    carried,
    quadrature,
    samples,
    stirred,
)
from rigidfluid.testing.fluid.exact import DENSITY, VISCOSITY, Kind, LinearFlow, enclosed, problem
from rigidfluid.testing.fluid.flow import Bodies, components

DROP, BACK = 2.0, 0.4
"""Pressure drop from the first to the second face, and pressure at the second one."""


class BalancesContract(FluidContract):
    """Momentum and energy, each where the discrete equations have it exactly."""

    @pytest.mark.parametrize("inertia", [False, True], ids=["stokes", "navier-stokes"])
    def test_flow_between_a_plane_of_symmetry_and_a_wall(self, dimension: int, inertia: bool) -> None:
        """Driven by pressures: u = Δp/(2μL)(1 - y²), in → out the power Δp Q, all of it dissipated.

        Midway from rest half the velocity dissipates a quarter, and the end's stress, where told, does half the work.
        """
        started = self.empty(_channel(dimension, inertia, wall="y1"), box(dimension, 3)).after(None)
        flow = started.after(0.1)
        points, advance = samples(dimension), flow.advance
        velocity, pressure = flow.probe(points)
        exact = np.zeros_like(points)
        exact[:, 0] = DROP / (2 * VISCOSITY) * (1 - points[:, 1] ** 2)
        self.assert_close(velocity, exact)
        self.assert_close(pressure, BACK + DROP * (1 - points[:, 0]), scale=10.0)
        work = DROP**2 / (3 * VISCOSITY)
        self.assert_close([advance.dissipation, advance.boundary_power], work, scale=10.0)
        midway = [started.advance.dissipation_midway, advance.dissipation_midway]
        self.assert_close(midway, [0.25 * work, work], scale=10.0)
        if started.advance.stress_power is not None:
            self.assert_close(started.advance.stress_power, 0.5 * work, scale=10.0)
        kinetic = 0.5 * DENSITY * (DROP / (2 * VISCOSITY)) ** 2 * 8 / 15
        self.assert_close(advance.kinetic_energy, kinetic if inertia else 0.0)

    @pytest.mark.parametrize("inertia", [False, True], ids=["stokes", "navier-stokes"])
    def test_flow_along_a_wall_that_slides(self, dimension: int, inertia: bool) -> None:
        """Couette's: u = U y between a wall at rest and one that slides at U, whose power μ U² is dissipated."""
        sliding = np.eye(dimension)[0] * DROP
        kinds = {"x0": _under(BACK), "x1": _under(BACK), "z0": Slip, "z1": Slip}
        kinds["y1"] = partial(NoSlip, sliding=lambda x: np.tile(sliding, (len(x), 1)))
        flow = self.empty(problem(dimension, kinds, inertia=inertia), box(dimension, 3)).after(None).after(0.1)
        points = samples(dimension)
        velocity, pressure = flow.probe(points)
        self.assert_close(velocity, points[:, 1:2] * sliding)
        self.assert_close(pressure, BACK, scale=10.0)
        work = VISCOSITY * DROP**2
        self.assert_close([flow.advance.dissipation, flow.advance.boundary_power], work, scale=10.0)

    def test_rest_stays_rest(self, dimension: int) -> None:
        """Bodies free and prescribed, under one pressure everywhere, while the mesh between them sways."""
        bodies = Bodies(np.ones(2), Bodies.uniform(balls_pose(dimension)).inertia, np.array([True, False]))
        flow = self.with_balls(problem(dimension, dict.fromkeys(("x0", "x1"), _under(BACK)), bodies=2), bodies)
        sway = np.full(dimension, 0.01)  # with 0.02 it could fold cells next to the balls
        for length in (0.1, 0.1, 0.05):
            flow = flow.after(length, points=stirred(flow.reference.points, np.sin(9 * (flow.time + length)) * sway))
            velocity, pressure = flow.probe(samples(dimension))
            self.assert_close(velocity, 0.0)
            self.assert_close(pressure, BACK)
            self.assert_close(components(flow.twist), 0.0)
            self.assert_close(components(flow.advance.hydrodynamic_wrench), 0.0)
            energies = (flow.advance.kinetic_energy, flow.advance.dissipation, flow.advance.boundary_power)
            self.assert_close(energies, 0.0)

    def test_force_balances_the_pressures(self, dimension: int) -> None:
        """Stokes flow past fixed bodies between planes of symmetry: Σ F = Δp · area at once; Δp Q is dissipated."""
        flow = self.with_balls(_channel(dimension, inertia=False)).after(0.1)
        force = flow.advance.hydrodynamic_wrench.force
        self.assert_close(force[:, 0].sum(), DROP, scale=10.0)
        assert np.all(force[:, 0] > 0.1 * DROP)
        self.assert_close(flow.advance.boundary_power, flow.advance.dissipation, scale=flow.advance.dissipation)

    @pytest.mark.parametrize("motion", range(2), ids=["along", "about"])
    def test_the_power_that_drives_bodies_is_dissipated(self, dimension: int, motion: int) -> None:
        """Stokes flow in closed walls: -Σ (F·U + T·ω) = dissipation, torques about points that are no centres."""
        pose = _off_centre(dimension)
        twist = np.zeros((2, 3 if dimension == 2 else 6))
        chosen = slice(0, dimension) if motion == 0 else slice(dimension, None)
        twist[:, chosen] = np.random.default_rng(3).normal(size=twist[:, chosen].shape)
        flow = self.with_balls(problem(dimension, bodies=2, inertia=False), pose=pose).after(0.1, twist=twist)
        driven = -np.sum(components(flow.advance.hydrodynamic_wrench) * twist)
        self.assert_close(flow.advance.dissipation, driven, scale=driven)
        self.assert_close(flow.advance.boundary_power, 0.0, scale=driven)
        self.assert_rigid(flow, twist, box_with_balls(dimension))

    @pytest.mark.parametrize("free", [False, True], ids=["prescribed", "free"])
    def test_what_turns_as_one_has_no_stress(self, dimension: int, free: bool) -> None:
        """Stokes flow u = ω × x + U on the faces: bodies that go along, or are free to, feel nothing."""
        spin = np.array([0.8, -0.5, 1.1])[: 1 if dimension == 2 else 3]
        drift = np.array([0.3, 0.2, -0.4])[:dimension]

        def turning(_time: float, points: FloatArray) -> FloatArray:
            return np.asarray(cross(np.tile(spin, (len(points), 1)), points) + drift)

        pose = _off_centre(dimension)
        twist = np.column_stack([turning(0.0, pose.position), np.tile(spin, (2, 1))])
        bodies = Bodies.uniform(pose, prescribed=not free)
        flow = self.with_balls(enclosed(dimension, turning, bodies=2, inertia=False), bodies, pose)
        flow = flow.after(None, twist=None if free else twist)
        _, pressure = flow.probe(samples(dimension))
        self.assert_close(components(flow.twist), twist, scale=10.0)
        self.assert_close(components(flow.advance.hydrodynamic_wrench), 0.0)
        self.assert_close([flow.advance.dissipation, flow.advance.boundary_power], 0.0)
        self.assert_close(np.ptp(pressure), 0.0, scale=10.0)
        self.assert_rigid(flow, twist, box_with_balls(dimension))

    @pytest.mark.parametrize("free", [False, True], ids=["prescribed", "free"])
    def test_fluid_and_bodies_accelerate_as_one(self, dimension: int, free: bool) -> None:
        """u = a t everywhere needs p = -ρ a·x: on a body F = ρ V a; one of the fluid's density goes along by itself."""
        pull, mesh = np.array([0.6, -0.4, 0.3])[:dimension], box_with_balls(dimension)
        moments = [ball_moments(mesh, ball) for ball in range(2)]
        volume, centroid = np.array([v for v, _ in moments]), np.array([c for _, c in moments])
        start = balls_pose(dimension)
        start = Pose(centroid if free else _off_centre(dimension).position, start.orientation)
        inertia = Bodies.uniform(start).inertia
        bodies = Bodies(DENSITY * volume, inertia, np.full(2, not free))

        def rising(time: float, points: FloatArray) -> FloatArray:
            return np.tile(time * pull, (len(points), 1))

        flow = self.with_balls(enclosed(dimension, rising, bodies=2), bodies, start)
        force = DENSITY * volume[:, None] * pull
        wrench = np.column_stack([force, moment(centroid - start.position, force)])
        for length in (0.1, 0.1, 0.05, 0.1):
            time = flow.time + length
            shift = np.tile(0.5 * time**2 * pull, (2, 1))
            twist = np.column_stack([np.tile(time * pull, (2, 1)), 0.0 * wrench[:, dimension:]])
            flow = flow.after(
                length,
                points=carried(flow.reference.points, shift),
                pose=Pose(start.position + shift, start.orientation),
                twist=None if free else twist,
            )
            self.assert_close(components(flow.twist), twist)
            self.assert_close(components(flow.advance.hydrodynamic_wrench), wrench)
            velocity, _ = flow.probe(samples(dimension))
            self.assert_close(velocity, rising(time, velocity))
            kinetic = 0.5 * DENSITY * (1.0 - volume.sum()) * time**2 * float(pull @ pull)
            self.assert_close(flow.advance.kinetic_energy, kinetic)
            self.assert_close(flow.advance.dissipation, 0.0)

    def test_newton_euler_holds_for_free_bodies(self, dimension: int) -> None:
        """mass_matrix · twist = load + wrench for a light body on a mesh in motion; the other moves as it is told.

        Which one is free changes on the way.
        """
        pose, size = balls_pose(dimension), 3 if dimension == 2 else 6
        inertia = Bodies.uniform(pose, mass=0.02).inertia
        flow = self.with_balls(problem(dimension, bodies=2), Bodies(np.full(2, 0.02), inertia, np.array([True, False])))
        rng, shift, mesh = np.random.default_rng(1), np.zeros((2, dimension)), box_with_balls(dimension)
        for number, length in enumerate((0.02, 0.02, 0.01, 0.02)):
            if number == 2:
                flow = replace(flow, bodies=replace(flow.bodies, prescribed=np.array([False, True])))
            shift = shift + length * flow.twist.velocity
            twist, push = rng.normal(size=(2, size)), 0.1 * rng.normal(size=(2, size))
            flow = flow.after(
                length,
                points=carried(flow.reference.points, shift),
                pose=Pose(pose.position + shift, pose.orientation),
                twist=twist,
                push=push,
            )
            found, wrench = components(flow.twist), components(flow.advance.hydrodynamic_wrench)
            prescribed = flow.bodies.prescribed
            np.testing.assert_array_equal(found[prescribed], twist[prescribed])
            moved = np.einsum("nij,nj->ni", flow.step.mass_matrix, found)
            self.assert_close((moved - flow.step.load)[~prescribed], wrench[~prescribed], scale=np.abs(wrench).max())
            assert np.abs(wrench[~prescribed]).min() > 1e-6 * np.abs(wrench).max()
            moved_mesh = replace(mesh, points=carried(mesh.points, shift))
            self.assert_rigid(flow, found, moved_mesh)

    def test_energy_carried_through_the_faces(self, dimension: int) -> None:
        """u = A x + b, steady, A diagonal: boundary power and the source's make up for what is dissipated."""
        rates = np.array([1.0, -0.6, -0.4] if dimension == 3 else [0.7, -0.7])
        steady = LinearFlow.steady(dimension)
        exact = LinearFlow(np.diag(rates), steady.drift, steady.slope)
        mesh = box(dimension, 3)
        flow = self.empty(enclosed(dimension, exact.velocity, exact.source), mesh).after(None).after(0.1)
        points, weights = quadrature(mesh)
        velocity = exact.velocity(1.0, points)
        dissipated = 2 * VISCOSITY * float(rates @ rates)
        given = float(weights @ np.sum(velocity * exact.source(1.0, points), axis=1))
        self.assert_close(flow.advance.dissipation, dissipated, scale=10.0)
        self.assert_close(flow.advance.boundary_power, dissipated - given, scale=10.0)
        self.assert_close(flow.advance.source_power, given, scale=10.0)
        kinetic = 0.5 * DENSITY * float(weights @ np.sum(velocity**2, axis=1))
        self.assert_close(flow.advance.kinetic_energy, kinetic, scale=10.0)

    def test_a_prediction_error_is_kinetic_energy(self, dimension: int) -> None:
        """Kinetic energy of velocity minus extrapolation: all of it if that is zero, none if that is the velocity."""
        flow = self.stir(self.stirred(dimension, steps=2))
        backend = flow.backend
        if type(backend).prediction_error is FluidBackend.prediction_error:
            pytest.skip("this backend leaves the choice of steps to the bodies")
        all_of_it, none = (
            backend.prediction_error(flow.fluid, flow.fluid, flow.mesh, np.array([share, 0.0])) for share in (0.0, 1.0)
        )
        self.assert_close(all_of_it, flow.advance.kinetic_energy, scale=flow.advance.kinetic_energy)
        self.assert_close(none, 0.0, scale=flow.advance.kinetic_energy)

    def test_convection_makes_no_energy(self, dimension: int) -> None:
        """A lid drives a fast flow that the cells do not resolve: in steady steps all that it gives is dissipated, by
        viscosity or by stabilisation."""
        flow = self.empty(enclosed(dimension, _lid), box(dimension, 4 if dimension == 2 else 3))
        for _ in range(3):
            flow = flow.after(None)
        dissipated = flow.advance.dissipation + flow.advance.grad_div
        self.assert_close(flow.advance.boundary_power, dissipated, scale=dissipated)


def _lid(_time: float, points: FloatArray) -> FloatArray:
    """The top goes along itself, fastest in its middle, and all else rests."""
    velocity, across = np.zeros_like(points), points[:, ::2]
    velocity[:, 0] = 100.0 * points[:, 1] * np.prod(4.0 * across * (1.0 - across), axis=1)
    return velocity


def _channel(dimension: int, inertia: bool, wall: str = "") -> FluidProblem:
    """Flow in a box from left to right, driven by pressures; the other faces are slip planes but for a ``wall``."""
    sides: dict[str, Kind] = dict.fromkeys(("y0", "y1", "z0", "z1"), Slip)
    if wall:
        sides[wall] = NoSlip
    return problem(dimension, sides | {"x0": _under(DROP + BACK), "x1": _under(BACK)}, 0 if wall else 2, inertia)


def _under(pressure: float) -> Kind:
    return partial(PrescribedPressure, value=lambda _time, points: np.full(len(points), pressure))


def _off_centre(dimension: int) -> Pose:
    """Poses whose positions are not the centres of the balls, so that torques and arms show."""
    pose = balls_pose(dimension)
    return Pose(pose.position + np.array([[0.04, -0.03, 0.05], [-0.02, 0.06, 0.01]])[:, :dimension], pose.orientation)
