"""Boxes and wakes of finer cells: how far away they are, and what size is wanted in and around them."""

import numpy as np
from falling import falling_disk
from mesh_tools import ball, box, box_walls, upright

from rigidfluid.checks import check
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.size.regions import RefinedBox, RefinedCapsule, curved_walls
from rigidfluid.core.mesh.size.size_field import LONGEST, Sizes, wanted_size
from rigidfluid.core.mesh.size.wake import Wake
from rigidfluid.core.model.types import Twist
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions
from rigidfluid.post.reports.plane import distance_grid
from rigidfluid.post.reports.view_plane import ViewPlane

POINTS = np.random.default_rng(0).uniform(-3.0, 3.0, (400, 2))
BOX = RefinedBox(np.array([-1.0, 0.0]), np.array([1.0, 2.0]), 0.05)


def nearest_of(samples, points):
    """Distance to the nearest of many points of a region."""
    return np.linalg.norm(points[:, None] - samples[None], axis=2).min(axis=1)


def test_distance_to_a_box():
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 81), np.linspace(0, 2, 81)), axis=-1).reshape(-1, 2)
    np.testing.assert_allclose(BOX.distance(POINTS), nearest_of(grid, POINTS), atol=0.02)
    assert not BOX.distance(np.array([[0.0, 1.0], [1.0, 2.0]])).any()


def test_distance_to_a_capsule():
    start, end = np.array([-1.0, 0.5]), np.array([1.5, -0.5])
    axis = start + np.linspace(0.0, 1.0, 500)[:, None] * (end - start)
    expected = np.maximum(nearest_of(axis, POINTS) - 0.4, 0.0)
    np.testing.assert_allclose(RefinedCapsule(start, end, 0.4, 0.05).distance(POINTS), expected, atol=1e-4)


def test_a_wake_is_where_its_body_has_been_and_a_body_at_rest_has_none():
    bodies, pose = [ball(0.1), ball(0.2)], upright([1.0, 1.0], [2.0, 1.0])
    twist = Twist(np.array([[0.0, -3.0], [0.0, 0.0]]), np.zeros((2, 1)))
    (found,) = Wake(time=0.5, size=0.02, growth=0.2, dimension=2).behind(bodies, pose, twist)
    np.testing.assert_allclose([found.start, found.end], [[1.0, 1.0], [1.0, 2.5]])
    assert (found.radius, found.size) == (0.1, 0.02)


def test_the_size_wanted_in_a_region_grows_from_there_and_is_never_coarser():
    bodies, pose = [ball(0.1)], upright([0.0, 1.0])
    plain, refined = Sizes(0.5, 0.01, 0.2), Sizes(0.5, 0.01, 0.2, regions=(BOX,))
    around = FluidDomain(bodies, pose, box([-2.0, -2.0], [2.0, 2.0]), ())
    before, after = (wanted_size(POINTS, around, sizes) for sizes in (plain, refined))
    np.testing.assert_allclose(after, np.minimum(before, 0.05 + 0.2 * BOX.distance(POINTS)))
    assert (after < before).any()
    assert (after[BOX.distance(POINTS) == 0.0] <= 0.05).all()


def test_the_first_mesh_has_the_cells_of_a_box_that_lies_between_the_vertices_of_a_coarse_one():
    lower, upper = np.zeros(2), np.array([2.0, 6.0])
    place = RefinedBox(np.array([0.9, 1.0]), np.array([1.1, 1.2]), 0.01)
    around = FluidDomain([ball(0.125)], upright([1.0, 4.0]), box(lower, upper), box_walls(lower, upper, 1))
    cells = [
        np.sum(place.distance(mesh.points[mesh.cells].mean(axis=1)) == 0.0)
        for mesh in (initial_mesh(around, Sizes(0.4, 0.05)), initial_mesh(around, Sizes(0.4, 0.05, regions=(place,))))
    ]
    expected = 0.2**2 / (np.sqrt(0.1875) * 0.01**2)
    assert cells[0] < 5
    assert 0.7 * expected < cells[1] < 1.5 * expected


def test_a_scene_s_wake_is_in_the_meshes_after_the_first():
    short = {"time": {"step": 0.004, "end": 0.012}, "output": {"every": 0.012}}
    mesh = {"size": 0.3, "size_body": 0.05, "remesh_every": 0.004, "wake": {"time": 0.1, "size": 0.03}}
    simulation = Simulation(falling_disk(**short, mesh=mesh, body={"velocity": [0.0, -10.0]}))
    behind = np.array([[1.0, 4.5], [1.0, 4.9]])

    def fineness():
        centres = simulation.state.mesh.points[simulation.state.mesh.cells].mean(axis=1)
        return [int(np.sum(np.linalg.norm(centres - point, axis=1) < 0.1)) for point in behind]

    before = fineness()
    simulation.go()
    assert all(after > 4 * count for after, count in zip(fineness(), before, strict=True))


def test_the_check_says_whether_a_scene_has_boxes_wakes_and_meshes_made_by_age():
    box_below = {"lower": [0.0, 0.0], "upper": [2.0, 1.0], "size": 0.05}
    keys = {"refine": [box_below], "wake": {"time": 0.1, "size": 0.03}, "remesh_every": 0.05}
    names = "boxes of finer cells", "finer cells in wakes", "re-meshing by age"
    for mesh, on in ((keys, True), ({}, False)):
        told = {feature.name: feature for feature in check(falling_disk(mesh=mesh)).features}
        assert [told[name].on for name in names] == [on] * 3
    assert told["boxes of finer cells"].why == "[[mesh.refine]] names none"


def stenosis(length=32.0):
    return Stenosis(StenosisOptions(length=length, width=8.0, radius=3.125), 2)


def test_curved_walls_ask_for_a_quarter_of_their_radius():
    first, second = curved_walls(stenosis(), size=1.0, size_wall=None)
    assert first.size == second.size == 3.125 / 4
    np.testing.assert_allclose(first.distance(np.array([[0.0, 0.0], [0.0, -1.0]])), [0.875, 0.125], atol=1e-15)
    assert curved_walls(stenosis(), size=0.7, size_wall=None) == ()


def test_the_size_of_curved_walls_may_be_given():
    assert [wall.size for wall in curved_walls(stenosis(), size=1.0, size_wall=0.2)] == [0.2, 0.2]
    assert curved_walls(box([0, 0], [1, 1]), size=1.0, size_wall=0.1) == ()


def test_curved_walls_are_as_fine_as_they_ask_for():
    body, pose, domain = ball(0.5), upright([-8.0, 0.0]), stenosis()
    sizes = Sizes(1.0, 0.3, regions=curved_walls(domain, 1.0, 0.25))
    mesh = initial_mesh(FluidDomain([body], pose, domain, surfaces_of(domain, 1)), sizes)
    ends = mesh.points[mesh.facets[mesh.markers >= 5]]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).max() <= LONGEST * 0.25


def test_the_outline_of_a_stenosis_has_its_bumps():
    x, y, distance = distance_grid(stenosis(), ViewPlane.coordinate_plane(0, 1, 2), np.zeros(2))
    i, j = np.argmin(np.abs(x)), np.argmin(np.abs(y + 2.0))
    np.testing.assert_allclose(distance[j, i], np.hypot(x[i], y[j] + 4.0) - 3.125, rtol=1e-14)
    assert distance[np.argmin(np.abs(y)), i] > 0.8
    assert (distance[[0, -1]] < 0).all()
    assert (distance[:, [0, -1]] < 0).all()
