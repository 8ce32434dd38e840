"""Conduction of a scalar inside bodies: exact solutions, balances, limits, and functions inside on facets outside."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from two_layers import (
    DIFFUSIVITY,
    ball,
    conducting,
    error_outside,
    exact_outside,
    first,
    gradient_found,
    gradient_inside,
    held,
    in_linear_field,
    inside,
    left_of_mode,
    node_points,
    nothing,
    round_mesh,
    started,
)

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.fluid.scalar import NO_FLUX, ScalarCondition, ScalarProblem
from rigidfluid.core.model.types import Pose
from rigidfluid.taylor_hood.elements.inside_space import InsideSpace, traces
from rigidfluid.testing.fluid.boxes import balls_pose, box_with_balls, carried, finer_box_with_balls
from rigidfluid.testing.fluid.exact import problem
from rigidfluid.testing.fluid.flow import Bodies, Flow, size


def constant(number):
    return lambda time, points: np.full(len(points), float(number))


@pytest.mark.parametrize("conductivity", [0.1, 10.0])
def test_a_disk_in_a_linear_field_is_of_order_three(conductivity):
    gradients, errors = [], []
    for length in (0.2, 0.1, 0.05):
        flow = in_linear_field(conductivity, length)
        gradients.append(abs(gradient_found(flow) - gradient_inside(conductivity, 2)))
        errors.append(error_outside(flow, exact_outside(conductivity, node_points(flow))))
    assert np.log2(gradients[0] / gradients[2]) > 6.5, gradients
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 2.8), errors


def test_a_disk_that_conducts_as_the_fluid_does_is_not_seen_by_a_linear_field():
    flow = in_linear_field(1.0, 0.1)
    assert gradient_found(flow) == pytest.approx(1.0, abs=5e-6)
    np.testing.assert_allclose(flow.fluid["scalar"], node_points(flow)[:, 0], atol=5e-4)
    np.testing.assert_allclose(flow.advance.scalar.flux, 0.0, atol=1e-10)


@pytest.mark.parametrize("conductivity", [0.1, 10.0])
def test_a_ball_has_the_gradient_of_theory(conductivity):
    flow = in_linear_field(conductivity, 0.35, dimension=3)
    assert gradient_found(flow) == pytest.approx(gradient_inside(conductivity, 3), rel=0.015)


def test_a_disk_of_the_fluids_properties_cools_as_the_fluid_would():
    """The same run with and without the disk, on meshes that have nothing in common."""

    def hill(time, points):
        return np.cos(0.5 * np.pi * np.linalg.norm(points, axis=1)) + 0.3 * points[:, 0]

    samples = np.random.default_rng(0).normal(size=(30, 2))
    samples *= 0.7 / np.linalg.norm(samples, axis=1, keepdims=True)
    found = []
    for conditions in ((conducting(1.0), held(nothing)), (held(nothing),)):
        flow = started(round_mesh(2, 0.1, empty=len(conditions) == 1), *conditions, initial=hill)
        for _ in range(10):
            flow = flow.after(0.05)
        found.append(
            (flow.backend.probe_scalar(flow.fluid, flow.mesh, flow.pose, samples), flow.advance.scalar.flux[-1])
        )
    (with_disk, flux), (without, other_flux) = found
    np.testing.assert_allclose(with_disk, without, rtol=2e-3)
    assert flux == pytest.approx(other_flux, rel=1e-4)


@pytest.mark.parametrize(("conductivity", "capacity"), [(0.2, 0.5), (5.0, 2.0)])
def test_the_slowest_mode_of_two_layers_is_of_order_two_in_time(conductivity, capacity):
    counts = 4, 8, 16
    errors = [abs(left_of_mode(conductivity, capacity, 0.8, count, 0.1) - np.exp(-0.8)) for count in counts]
    assert errors[-1] < 2e-3
    assert np.log2(errors[1] / errors[2]) > 1.85, errors


def test_a_disk_that_turns_with_its_fluid_has_what_it_has_at_rest():
    """In the body's frame nothing is seen of a turn of all, which its mesh does not make."""
    spin, length, still, turning = 1.5, 0.01, [], []

    def rigid(time, points):
        return spin * np.column_stack([-points[:, 1], points[:, 0]])

    for velocity, found in ((None, still), (rigid, turning)):
        twist = None if velocity is None else np.array([[0.0, 0.0, spin]])
        flow = started(round_mesh(2, 0.1), conducting(0.5), NO_FLUX, initial=first, velocity=velocity, twist=twist)
        for _ in range(20):
            angle = 0.0 if velocity is None else spin * length
            pose = Pose(flow.pose.position, flow.pose.orientation + angle)
            flow = flow.after(length, pose=pose, twist=twist)
            found.append(flow.fluid["scalar_inside"])
    change = np.abs(still[-1] - still[0]).max()
    assert np.abs(turning[-1] - still[-1]).max() < 0.02 * change
    assert change > 0.02


def stirred(dimension, *conditions, initial):
    """A flow around two balls, one prescribed and one free, that are set in motion."""
    posed, radius = problem(dimension, bodies=2), 0.1
    rest = (NO_FLUX,) * (2 + len(posed.conditions) - len(conditions))
    posed = replace(posed, scalar=ScalarProblem(DIFFUSIVITY, initial, (*conditions, *rest)))
    pose = balls_pose(dimension)
    bodies = replace(Bodies.uniform(pose, mass=0.05), prescribed=np.array([True, False]))
    backend = ScikitFem(ScikitFem.Options(), posed)
    return Flow.start(backend, box_with_balls(dimension), pose, bodies=bodies), radius


def stir(flow, length=0.02):
    d = flow.pose.position.shape[1]
    way = np.array([[1.0, 0.5, -0.5], [0.5, -1.0, 0.5]])[:, :d]
    shift = 0.03 * np.sin(4.0 * (flow.time + length)) * way
    start, twist = balls_pose(d), np.full((2, size(flow.pose)), 0.5)
    turn = flow.time + length
    orientation = np.full((2, 1), turn) if d == 2 else np.tile([np.cos(turn), np.sin(turn), 0.0, 0.0], (2, 1))
    points = carried(flow.reference.points, shift)
    pose = Pose(start.position + shift, orientation)
    return flow.taken(flow.step_after(length, points=points, pose=pose, twist=twist, push=-0.1 * twist), length)


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_that_conduct_and_their_fluid_lose_nothing(dimension):
    balls = [conducting(k, c, 0.1, dimension, 0.08, order=1) for k, c in ((0.5, 2.0), (20.0, 0.7))]
    flow, radius = stirred(dimension, *balls, initial=first)
    volume, sums = ball(radius, dimension).volume, []
    for _ in range(5):
        flow = stir(flow)
        account = flow.advance.scalar
        assert abs(account.imbalance) < 1e-11 * account.content
        sums.append(account.content + volume * (2.0 * account.inside[0] + 0.7 * account.inside[1]))
    assert np.ptp(sums) < 1e-12 * abs(sums[0])
    assert np.abs(account.flux[:2]).min() > 1e-4
    np.testing.assert_allclose(account.value[:2], account.inside[:2], atol=0.03)  # each that of its own inside
    assert account.least == min(flow.fluid[name].min() for name in ("scalar", "scalar_inside"))
    np.testing.assert_array_equal(account.inside[2:], account.value[2:])


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_constant_stays_one_in_bodies_and_fluid(dimension):
    flow, _ = stirred(dimension, conducting(0.5, 2.0, 0.1, dimension, 0.08, order=1), initial=constant(7.5))
    for _ in range(5):
        flow = stir(flow)
    for name in ("scalar", "scalar_inside"):
        np.testing.assert_allclose(flow.fluid[name], 7.5, rtol=0, atol=1e-12)


def test_a_body_that_conducts_well_is_as_one_with_one_value():
    volume, found = ball(0.1, 2).volume, []
    for condition in (conducting(1e4, 2.0, 0.1, length=0.08, order=1), ScalarCondition(capacity=2.0 * volume)):
        flow, _ = stirred(2, replace(condition, value=constant(3.0)), initial=constant(1.0))
        for _ in range(10):
            flow = stir(flow, 0.05)
        found.append(flow.advance.scalar)
    well, lumped = found
    assert well.inside[0] == pytest.approx(lumped.value[0], rel=1e-4)
    assert (well.least, well.greatest) == pytest.approx((lumped.least, lumped.greatest), rel=1e-4)
    np.testing.assert_allclose(well.flux, lumped.flux, rtol=1e-3, atol=1e-9)


def test_a_new_mesh_leaves_what_is_inside():
    flow, radius = stirred(2, conducting(0.5, 2.0, 0.1, length=0.08, order=1), initial=first)
    flow = stir(stir(flow))
    new = finer_box_with_balls(2, flow.pose.position - balls_pose(2).position)
    moved, _ = flow.backend.transfer(flow.fluid, flow.mesh, new)
    for name in ("scalar_inside", "scalar_inside_previous"):
        np.testing.assert_array_equal(moved[name], flow.fluid[name])
    before, now = (backend_content(flow, mesh, state) for mesh, state in ((flow.mesh, flow.fluid), (new, moved)))
    volume, pose = ball(radius, 2).volume, flow.pose
    flow = replace(flow, mesh=new, reference=new, fluid=moved)
    step = flow.step_after(0.02, points=new.geometry, pose=pose, twist=np.zeros((2, 3)))
    account = flow.backend.advance(moved, new, step).scalar
    change = account.content - now + 2.0 * volume * (account.inside[0] - before[1])
    assert abs(change) < 1e-5 * abs(now)


def backend_content(flow, mesh, state):
    equations = flow.backend._scalar_equations(mesh)
    content = equations.content_by_node(mesh.geometry, state["scalar"]).sum()
    if mesh is not flow.mesh:
        return content
    return content, equations.insides.means(np.zeros(6), state["scalar_inside"])[0]


def test_provisional_steps_and_shapes_know_what_is_inside():
    flow, _ = stirred(2, conducting(0.5, 2.0, 0.1, length=0.08, order=1), initial=first)
    flow = stir(flow)
    shapes = flow.backend.state_shapes(flow.mesh, flow.pose)
    assert shapes == {name: value.shape for name, value in flow.fluid.items()}
    advance = flow.backend.advance(flow.fluid, flow.mesh, replace(flow.step_after(0.02), provisional=True))
    np.testing.assert_array_equal(advance.fluid["scalar_inside"], flow.fluid["scalar_inside"])


def test_bodies_of_one_shape_share_their_elements(monkeypatch):
    made = []

    class Counted(InsideSpace):
        def __init__(self, inside):
            super().__init__(inside)
            made.append(inside)

    monkeypatch.setattr("rigidfluid.taylor_hood.stepping.insides.InsideSpace", Counted)
    both = [conducting(k, 1.0, 0.1, length=0.08, order=1) for k in (0.5, 2.0)]
    flow, _ = stirred(2, *both, initial=first)
    spaces = flow.backend._insides.spaces
    assert spaces[0] is spaces[1]
    assert len(made) == 1
    assert len(flow.fluid["scalar_inside"]) == 2 * spaces[0].nodes


def on_facets(dimension):
    """A flow around balls, and the nodes of the facets on the first one with their places."""
    flow, _ = stirred(dimension, initial=nothing)
    facets = flow.backend.numbering_of(flow.mesh).facet_nodes(flow.mesh.facets[flow.mesh.markers == 0])
    return flow, facets, node_points(flow)[facets]


@pytest.mark.parametrize("dimension", [2, 3])
def test_quadratic_functions_stay_as_they_are_on_flat_facets(dimension):
    flow, facets, points = on_facets(dimension)

    def bent(x):
        return sparse.csr_array(np.column_stack([np.ones(len(x)), 1.0 + x[:, 0] * x[:, 1] - 2.0 * x[:, -1] ** 2]))

    nodes, rows = traces(facets, points, bent)
    np.testing.assert_array_equal(nodes, np.unique(facets))
    np.testing.assert_allclose(rows.toarray(), bent(node_points(flow)[nodes]).toarray(), atol=1e-12)


def test_traces_have_the_integral_of_functions_inside():
    """By as many points on a facet, so that a uniform flux reaches each node inside as it should."""
    flow, facets, points = on_facets(2)
    space, centre = InsideSpace(inside(0.15, 2, 0.07)), flow.pose.position[0]

    def basis(x):
        return space.basis(x - centre)

    nodes, rows = traces(facets, points, basis)
    np.testing.assert_allclose(rows.sum(axis=1), 1.0, atol=1e-13)
    length = np.linalg.norm(points[:, 1] - points[:, 0], axis=1)
    weight = np.zeros(len(node_points(flow)))
    np.add.at(weight, facets, length[:, None] * np.array([1.0, 1.0, 4.0]) / 6.0)
    at, rule = np.polynomial.legendre.leggauss(8)
    where = points[:, :1] + 0.5 * (1.0 + at)[:, None] * (points[:, 1:2] - points[:, :1])
    exact = np.outer(length, 0.5 * rule).ravel() @ basis(where.reshape(-1, 2))
    np.testing.assert_allclose(weight[nodes] @ rows, exact, atol=1e-14)
