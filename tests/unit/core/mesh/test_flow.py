"""The flow that size fields see: on a mesh, at rest, and as the ranks of a run hold it."""

import numpy as np
import pytest
from mesh_tools import ball, box, upright
from threaded_ranks import on_ranks

from rigidfluid.api import AtRest, Mesh, Twist
from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.flow import FlowOnMesh, flow_on, vertex_gradient
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.testing.size_field import Whirl

SLOPES = {2: np.array([[1.0, -2.0], [0.5, -1.0]]), 3: np.array([[1.0, -2.0, 0.3], [0.5, 1.0, 4.0], [-0.2, 3.0, -2.0]])}


def mesh_around_a_ball(dimension: int, size: float = 0.4) -> Mesh:
    around = FluidDomain([ball(0.3, dimension)], upright([0.0] * dimension), box([-1] * dimension, [1] * dimension), ())
    return generate_mesh(around, Sizes(size, 0.5 * size, 0.5))


def twist(dimension: int) -> Twist:
    return AtRest(1, dimension).twist


def inside(dimension: int) -> np.ndarray:
    points = np.random.default_rng(0).uniform(-0.95, 0.95, (200, dimension))
    return points[np.linalg.norm(points, axis=1) > 0.45]


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_linear_flow_is_exact_everywhere(dimension):
    mesh, slopes = mesh_around_a_ball(dimension), SLOPES[dimension]
    flow = FlowOnMesh(mesh, 3.0 + mesh.points @ slopes.T, mesh.points[:, 0], twist(dimension))
    points = inside(dimension)
    np.testing.assert_allclose(flow.velocity(points), 3.0 + points @ slopes.T, atol=1e-12)
    np.testing.assert_allclose(flow.pressure(points), points[:, 0], atol=1e-12)
    np.testing.assert_allclose(flow.gradient(points), np.broadcast_to(slopes, (len(points), *slopes.shape)), atol=1e-11)


def test_vorticity_is_the_curl():
    in_plane = FlowOnMesh(mesh := mesh_around_a_ball(2), mesh.points @ SLOPES[2].T, mesh.points[:, 0], twist(2))
    np.testing.assert_allclose(in_plane.vorticity(inside(2)), 2.5, atol=1e-11)
    spin = np.array([0.5, -1.0, 2.0])
    in_space = FlowOnMesh(mesh := mesh_around_a_ball(3), np.cross(spin, mesh.points), mesh.points[:, 0], twist(3))
    np.testing.assert_allclose(in_space.vorticity(inside(3)), np.tile(2.0 * spin, (len(inside(3)), 1)), atol=1e-11)


def test_slopes_are_those_of_a_loop_over_the_cells():
    mesh = mesh_around_a_ball(2)
    values = np.sin(mesh.points @ SLOPES[2])
    for vertex in range(0, len(mesh.points), 7):
        total, weight = np.zeros((2, 2)), 0.0
        for cell in mesh.cells[(mesh.cells == vertex).any(axis=1)]:
            edges, change = np.diff(mesh.points[cell], axis=0), np.diff(values[cell], axis=0)
            area = 0.5 * abs(np.linalg.det(edges))
            total, weight = total + area * np.linalg.solve(edges, change).T, weight + area
        np.testing.assert_allclose(vertex_gradient(mesh, values)[vertex], total / weight, atol=1e-12)


def test_the_vorticity_of_a_smooth_flow_converges():
    whirl, errors = Whirl(twist(2)), []
    for size in (0.2, 0.1, 0.05):
        mesh = mesh_around_a_ball(2, size)
        flow = FlowOnMesh(mesh, whirl.velocity(mesh.points), whirl.pressure(mesh.points), twist(2))
        errors.append(np.sqrt(np.mean((flow.vorticity(inside(2)) - whirl.vorticity(inside(2))) ** 2)))
    assert errors[0] > 2.5 * errors[1] > 6.0 * errors[2]


def test_a_point_outside_takes_the_nearest_cell_s_values():
    mesh = mesh_around_a_ball(2)
    flow = FlowOnMesh(mesh, mesh.points.copy(), mesh.points[:, 0], twist(2))
    np.testing.assert_allclose(flow.velocity(np.array([[1.1, 0.0]])), [[1.0, 0.0]], atol=0.05)


@pytest.mark.parametrize("dimension", [2, 3])
def test_before_the_first_mesh_all_is_at_rest(dimension):
    flow, points = AtRest(3, dimension), inside(dimension)
    for values, width in ((flow.velocity(points), dimension), (flow.vorticity(points), {2: 1, 3: 3}[dimension])):
        np.testing.assert_array_equal(values, np.zeros((len(points), width)))
    np.testing.assert_array_equal(flow.pressure(points), np.zeros(len(points)))
    assert flow.speed == 0.0
    assert flow.twist.velocity.shape == (3, dimension)


def test_the_root_sees_the_flow_of_all_ranks():
    mesh = mesh_around_a_ball(2)
    asked = []

    class Backend:
        def probe(self, fluid, part, points):
            asked.append(len(points))
            return points @ SLOPES[2].T, points[:, 0]

    def work(ranks):
        return flow_on(Backend(), {}, distributed(mesh if ranks.is_root else None, ranks), twist(2))

    found = on_ranks(3, work)
    assert [flow is None for flow in found] == [False, True, True]
    assert asked == [len(mesh.points)] * 3
    np.testing.assert_allclose(found[0].velocity(inside(2)), inside(2) @ SLOPES[2].T, atol=1e-12)
