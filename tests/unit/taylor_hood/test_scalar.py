"""A transported scalar: orders, constants, balances, bodies with a capacity, buoyancy and new meshes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.conditions import PrescribedPressure, PrescribedVelocity
from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.fluid.material import Newtonian
from rigidfluid.core.fluid.scalar import NO_FLUX, Buoyancy, ScalarCondition, ScalarProblem
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose
from rigidfluid.errors import PluginError
from rigidfluid.testing.fluid.boxes import (
    balls_pose,
    box,
    box_with_balls,
    carried,
    finer_box_with_balls,
    nobody,
    quadrature,
    swayed,
)
from rigidfluid.testing.fluid.exact import LinearFlow, enclosed, problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, size

DIFFUSIVITY = 0.3


def held(value):
    return ScalarCondition(value=value)


def constant(number):
    return lambda time, points: np.full(len(points), float(number))


def with_scalar(posed, *conditions, initial=None, **others):
    """The problem with a scalar, on whose other surfaces nothing goes through."""
    count = posed.bodies + len(posed.conditions)
    filled = (*conditions, *[NO_FLUX] * (count - len(conditions)))
    scalar = ScalarProblem(DIFFUSIVITY, initial or constant(0.0), filled, **others)
    return replace(posed, scalar=scalar)


def started(posed, mesh, pose=None, **given):
    backend = ScikitFem(ScikitFem.Options(), posed)
    return Flow.start(backend, mesh, nobody(posed.dimension) if pose is None else pose, **given)


def scalar_at(flow, points):
    """The scalar at points, by the sampling of velocities."""
    from rigidfluid.taylor_hood.elements.sampling import Samples

    return Samples(flow.mesh, flow.backend.numbering_of(flow.mesh), points).quadratic(flow.fluid["scalar"])


def stirred(posed, mass=0.05):
    """A flow around two balls, one prescribed and one free, set in motion."""
    bodies = replace(Bodies.uniform(balls_pose(posed.dimension), mass=mass), prescribed=np.array([True, False]))
    return started(posed, box_with_balls(posed.dimension), balls_pose(posed.dimension), bodies=bodies)


def stir(flow, length=0.02):
    start, d = balls_pose(flow.pose.position.shape[1]), flow.pose.position.shape[1]
    way = np.array([[1.0, 0.5, -0.5], [0.5, -1.0, 0.5]])[:, :d]
    shift = 0.03 * np.sin(4.0 * (flow.time + length)) * way
    twist = np.full((2, size(start)), 0.5)
    pose = Pose(start.position + shift, start.orientation)
    points = carried(flow.reference.points, shift)
    return flow.taken(flow.step_after(length, points=points, pose=pose, twist=twist, push=-0.1 * twist), length)


@pytest.mark.parametrize("dimension", [2, 3])
def test_order_three_in_space(dimension):
    exact, wave = LinearFlow.steady(dimension), np.array([2.0, 1.5, 1.0])[:dimension]

    def value(time, points):
        return np.sin(points @ wave)

    def source(time, points):
        slope = np.cos(points @ wave)[:, None] * wave
        carried_along = np.sum(exact.velocity(time, points) * slope, axis=1)
        return carried_along + DIFFUSIVITY * (wave @ wave) * value(time, points)

    errors = []
    for divisions in (4, 8) if dimension == 2 else (2, 4):
        posed = enclosed(dimension, exact.velocity, exact.source)
        posed = with_scalar(posed, *[held(value)] * (2 * dimension), source=source)
        mesh = box(dimension, divisions)
        flow = started(posed, mesh).after(None)
        points, weights = quadrature(mesh)
        errors.append(np.sqrt(weights @ (scalar_at(flow, points) - value(0.0, points)) ** 2))
    assert np.log2(errors[0] / errors[1]) > 2.8, errors


@pytest.mark.parametrize("pattern", [np.ones(5), np.array([1.0, 1.4, 0.7, 1.2, 0.7])], ids=["even", "uneven"])
def test_order_two_in_time_on_a_swaying_mesh(pattern):
    """Of second degree in space, in a linear flow: only time errs."""
    exact, bent = LinearFlow.steady(2), np.array([[0.7, 0.3], [0.3, -0.4]])

    def value(time, points):
        return np.cos(3.0 * time) * (1.0 + np.einsum("ni,ij,nj->n", points, bent, points))

    def source(time, points):
        shape = 1.0 + np.einsum("ni,ij,nj->n", points, bent, points)
        along = np.sum(exact.velocity(time, points) * (2.0 * points @ bent), axis=1)
        rest = along - DIFFUSIVITY * 2.0 * np.trace(bent)
        return -3.0 * np.sin(3.0 * time) * shape + np.cos(3.0 * time) * rest

    posed = with_scalar(enclosed(2, exact.velocity, exact.source), *[held(value)] * 4, initial=value, source=source)
    samples, errors = np.random.default_rng(1).uniform(0.1, 0.9, (40, 2)), []
    for count in (4, 8, 16):
        flow = started(posed, box(2, 4)).after(None)
        flow = replace(flow, fluid={**flow.fluid, **dict.fromkeys(("scalar", "scalar_previous"), _start(flow, value))})
        lengths = np.tile(pattern, count)
        for length in lengths * (0.5 / lengths.sum()):
            shift = 0.06 * np.array([np.sin(6.0 * (flow.time + length)), np.cos(5.0 * (flow.time + length)) - 1.0])
            flow = flow.after(length, points=swayed(flow.reference.points, shift))
        errors.append(np.abs(scalar_at(flow, samples) - value(flow.time, samples)).max())
    assert np.log2(errors[1] / errors[2]) > 1.85, errors


def _start(flow, value):
    return value(0.0, flow.backend.numbering_of(flow.mesh).node_points(flow.mesh.geometry))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_constant_stays_one_around_moving_bodies(dimension):
    posed = with_scalar(
        problem(dimension, bodies=2),
        *(ScalarCondition(capacity=0.02), NO_FLUX, held(constant(7.5))),
        initial=constant(7.5),
    )
    flow = stirred(posed)
    for _ in range(5):
        flow = stir(flow)
    assert np.abs(flow.advance.fluid["velocity"]).max() > 0.1
    np.testing.assert_allclose(flow.fluid["scalar"], 7.5, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_balance_closes_around_moving_bodies(dimension):
    """Whatever goes in: through faces and bodies, and by a source."""
    posed = with_scalar(
        problem(dimension, bodies=2),
        *(held(constant(2.0)), ScalarCondition(flux=constant(0.3)), held(constant(1.0))),
        ScalarCondition(flux=lambda time, points: points[:, 0] * np.cos(time)),
        source=lambda time, points: np.sin(points[:, 1]) + 5.0,
        initial=lambda time, points: points[:, 0],
    )
    flow = stirred(posed)
    for _ in range(5):
        flow = stir(flow)
        account = flow.advance.scalar
        assert abs(account.rate) > 1.0
        assert abs(account.imbalance) < 1e-11 * np.abs(account.flux).max()
    radius = 0.1
    area = 2.0 * np.pi * radius if dimension == 2 else 4.0 * np.pi * radius**2
    assert account.flux[1] == pytest.approx(0.3 * area, rel=0.03 if dimension == 2 else 0.35)


def test_a_body_with_a_capacity_keeps_the_sum_with_its_fluid():
    """In a closed box with moving bodies no content is lost, and both become equal."""
    capacity = 0.2
    posed = with_scalar(
        problem(2, bodies=2), ScalarCondition(value=constant(3.0), capacity=capacity), initial=constant(1.0)
    )
    flow, sums = stirred(posed), []
    for _ in range(30):
        flow = stir(flow, 0.05)
        account = flow.advance.scalar
        sums.append(account.content + capacity * account.value[0])
    assert np.ptp(sums) < 1e-12 * sums[0]
    assert 1.0 < account.value[0] < 1.5
    assert account.greatest - account.least < 0.05


def test_conduction_between_faces_is_linear():
    conditions = held(constant(1.0)), held(constant(3.0))
    flow = started(with_scalar(problem(2), *conditions, initial=lambda time, points: 1.0 + points[:, 0]), box(2, 3))
    for _ in range(60):
        flow = flow.after(0.2)
    points = np.random.default_rng(0).uniform(0.0, 1.0, (20, 2))
    np.testing.assert_allclose(scalar_at(flow, points), 1.0 + 2.0 * points[:, 0], atol=1e-10)
    np.testing.assert_allclose(flow.advance.scalar.flux, [-2.0 * DIFFUSIVITY, 2.0 * DIFFUSIVITY, 0.0, 0.0], atol=1e-10)


def stream(speed, *conditions):
    """Fluid that goes with this speed through a box, whose second face is open; at first it has 1."""
    along = partial(PrescribedVelocity, value=lambda time, points: np.tile([speed, 0.0], (len(points), 1)))
    kinds = {"x0": along, "x1": PrescribedPressure, "y0": along, "y1": along}
    return started(with_scalar(problem(2, kinds), *conditions, initial=constant(1.0)), box(2, 4))


@pytest.mark.parametrize("value", [None, 4.0])
def test_what_flows_out_takes_the_scalar_with_it(value):
    """It comes in with 2 at a speed of 0.5, and leaves through the open end with what it has there."""
    flow = stream(0.5, held(constant(2.0)), NO_FLUX if value is None else held(constant(value)))
    for step in range(60):
        flow = flow.after(0.2)
        account = flow.advance.scalar
        if step > 0:  # before, the fluid has not yet the speed of the face
            assert account.flux[1] == pytest.approx(-0.5 * account.value[1], rel=1e-6)
            assert abs(account.imbalance) < 1e-8
        if step == 2:
            assert 1.0 < account.value[1] < 1.9
    np.testing.assert_allclose(account.flux, [1.0, -1.0, 0.0, 0.0], atol=1e-6)
    assert account.greatest == pytest.approx(2.0, abs=1e-6)


def test_what_comes_in_through_an_open_end_has_the_value_that_is_given():
    flow = stream(-0.5, NO_FLUX, held(constant(4.0)))
    for step in range(80):
        flow = flow.after(0.2)
        account = flow.advance.scalar
        if step > 0:
            assert account.flux[1] == pytest.approx(2.0, rel=1e-6)
            assert account.flux[0] == pytest.approx(-0.5 * account.value[0], rel=1e-6)
    assert account.least == pytest.approx(4.0, abs=1e-3)


def test_a_uniform_buoyancy_is_borne_by_the_pressure():
    gravity, expansion = np.array([0.3, -9.0]), 0.01
    buoyancy = Buoyancy(expansion, reference=2.0, gravity=gravity)
    posed = with_scalar(problem(2), initial=constant(5.0), buoyancy=buoyancy)
    flow = started(posed, box(2, 3)).after(0.1).after(0.1)
    points = np.random.default_rng(0).uniform(0.0, 1.0, (20, 2))
    velocity, pressure = flow.probe(points)
    np.testing.assert_allclose(velocity, 0.0, atol=1e-9)
    lifted = -posed.density * expansion * 3.0 * gravity
    np.testing.assert_allclose(pressure, (points - 0.5) @ lifted, atol=1e-8)
    assert flow.advance.source_power == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("rayleigh", "nusselt", "divisions"), [(1e3, 1.118, 8), (1e4, 2.243, 12)])
def test_a_square_cavity_has_the_nusselt_number_of_de_vahl_davis(rayleigh, nusselt, divisions):
    """De Vahl Davis (1983), at a Prandtl number of 0.71; what goes in at one side goes out at the other."""
    prandtl = 0.71
    buoyancy = Buoyancy(1.0, 0.5, np.array([0.0, -rayleigh * prandtl]))
    conditions = held(constant(1.0)), held(constant(0.0)), NO_FLUX, NO_FLUX
    scalar = ScalarProblem(1.0, lambda time, points: 1.0 - points[:, 0], conditions, buoyancy=buoyancy)
    walls = problem(2).conditions
    posed = FluidProblem(2, 0, 1.0, Newtonian(prandtl), True, walls, scalar=scalar)
    flow = started(posed, box(2, divisions))
    for _ in range(60):
        flow = flow.after(0.01)
    flux = flow.advance.scalar.flux
    assert flux[0] == pytest.approx(nusselt, rel=4e-3)
    assert flux[0] + flux[1] == pytest.approx(0.0, abs=1e-3)
    assert flow.advance.source_power == pytest.approx(flow.advance.dissipation, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_new_mesh_has_the_content_and_no_new_extremes(dimension):
    posed = with_scalar(
        problem(dimension, bodies=2), held(constant(0.3)), initial=lambda time, points: np.sin(9.0 * points[:, 0])
    )
    flow = stir(stir(stirred(posed)))
    new = finer_box_with_balls(dimension, flow.pose.position - balls_pose(dimension).position)
    backend, fluid = flow.backend, flow.fluid
    before = backend._scalar_equations(flow.mesh)
    moved, _ = backend.transfer(fluid, flow.mesh, new)
    after = backend._scalar_equations(new)
    geometries = (flow.mesh.geometry, new.geometry), (fluid["points_previous"], moved["points_previous"])
    for name, (there, here) in zip(("scalar", "scalar_previous"), geometries, strict=True):
        level = before.mean(there, fluid[name])
        content = before.content_by_node(there, fluid[name] - level).sum()
        assert after.content_by_node(here, moved[name] - level).sum() == pytest.approx(content, abs=1e-13)
        assert fluid[name].min() <= moved[name].min() <= moved[name].max() <= fluid[name].max()
    assert moved["scalar_remeshing"] > 1e-9
    ball = backend._any_discretisation(new).surfaces.body_nodes[0]
    np.testing.assert_array_equal(moved["scalar"][ball], 0.3)


def test_a_constant_is_kept_by_a_new_mesh():
    flow = stir(stirred(with_scalar(problem(2, bodies=2), initial=constant(-3.0))))
    new = finer_box_with_balls(2, flow.pose.position - balls_pose(2).position)
    moved, _ = flow.backend.transfer(flow.fluid, flow.mesh, new)
    np.testing.assert_allclose(moved["scalar"], -3.0, rtol=0, atol=1e-13)


def test_a_provisional_step_carries_the_scalar_unsolved():
    flow = stir(stirred(with_scalar(problem(2, bodies=2), held(constant(1.0)))))
    step = replace(flow.step_after(0.02), provisional=True)
    advance = flow.backend.advance(flow.fluid, flow.mesh, step)
    assert advance.scalar is None
    np.testing.assert_array_equal(advance.fluid["scalar"], flow.fluid["scalar"])


class Silent(FluidBackend):
    """Says that it solves for a scalar, and tells nothing of it."""

    name, scalars = "silent", True

    def advance(self, fluid, mesh, step):
        found = ScikitFem(ScikitFem.Options(), self.problem).advance(fluid, mesh, step)
        return replace(found, scalar=None)

    initial = response = transfer = fields = probe = unknowns = forget = None


def test_a_backend_that_tells_nothing_of_its_scalar_is_refused():
    flow = started(with_scalar(problem(2)), box(2, 2))
    backend = Silent(PartOptions(), flow.backend.problem)
    with pytest.raises(PluginError, match=r"advance: found scalar"):
        backend.advance(flow.fluid, flow.mesh, flow.step_after(0.1))


def test_where_two_faces_meet_the_first_one_holds_the_value():
    flow = started(with_scalar(problem(2), held(constant(1.0)), NO_FLUX, held(constant(2.0))), box(2, 2)).after(0.1)
    corner = np.flatnonzero((flow.mesh.points == 0.0).all(axis=1))
    beside = np.flatnonzero((flow.mesh.points == [0.5, 0.0]).all(axis=1))
    np.testing.assert_array_equal(flow.fluid["scalar"][np.concatenate([corner, beside])], [1.0, 2.0])
