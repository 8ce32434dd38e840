"""The harmonic map that moves the mesh."""

import numpy as np
import pytest
from gathered_backend import OnTheRoot
from mesh_tools import ball, box, edges_of, ellipsoid, nobody, upright
from threaded_ranks import on_ranks

from rigidfluid.core.mechanics.frames import to_body_frame
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion, held_components, stiffness
from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Pose

LOWER, UPPER = np.zeros(2), np.array([2.0, 3.0])
LOW, HIGH = np.full(3, -1.0), np.ones(3)
BOX, CUBE = box(LOWER, UPPER), box(LOW, HIGH)


def domain_of(mesh):
    return BOX if mesh.points.shape[1] == 2 else CUBE


def motion_of(mesh, bodies, pose, *how):
    return MeshMotion(mesh, FluidDomain(bodies, pose, domain_of(mesh), ()), *how)


@pytest.fixture(scope="module")
def disk():
    pose = upright([1, 2])
    return [ball(0.125)], pose, generate_mesh(FluidDomain([ball(0.125)], pose, BOX, ()), Sizes(0.2, 0.02, 0.2))


@pytest.fixture(scope="module")
def ellipse():
    pose, body = Pose(np.array([[0.9, 1.2]]), np.array([[0.7]])), ellipsoid(0.3, 0.1)
    return [body], pose, generate_mesh(FluidDomain([body], pose, BOX, ()), Sizes(0.2, 0.02, 0.2))


@pytest.fixture(scope="module")
def solid():
    pose, body = upright([0, 0, 0]), ellipsoid(0.5, 0.25, 0.3)
    return [body], pose, generate_mesh(FluidDomain([body], pose, CUBE, ()), Sizes(0.6, 0.2, 0.4))


def test_the_reference_pose_gives_the_reference_mesh(ellipse):
    bodies, pose, mesh = ellipse
    np.testing.assert_allclose(motion_of(mesh, bodies, pose).move(pose), mesh.points, atol=1e-15)


def test_a_disk_s_mesh_translates_and_does_not_turn(disk):
    bodies, pose, mesh = disk
    moved = motion_of(mesh, bodies, pose).move(Pose(pose.position + [0.01, -0.05], np.array([[2.0]])))
    surface = np.unique(mesh.facets[mesh.markers == 0])
    np.testing.assert_allclose(moved[surface], mesh.points[surface] + [0.01, -0.05], atol=1e-15)


def test_an_ellipse_s_vertices_turn_with_it(ellipse):
    bodies, pose, mesh = ellipse
    new = Pose(pose.position + [0.02, 0.03], pose.orientation + 0.2)
    moved = motion_of(mesh, bodies, pose).move(new)
    surface = np.unique(mesh.facets[mesh.markers == 0])
    local = to_body_frame(new, 0, moved[surface])
    np.testing.assert_allclose(local, to_body_frame(pose, 0, mesh.points[surface]), atol=1e-15)
    assert np.abs(bodies[0].signed_distance(local)).max() < 1e-12
    assert cell_quality(moved, mesh.cells).min() > 0.2


def test_an_ellipsoid_s_vertices_turn_with_it_in_space(solid):
    bodies, pose, mesh = solid
    new = Pose(pose.position + [0.05, 0, -0.02], np.array([[np.cos(0.1), 0, np.sin(0.1), 0]]))
    moved = motion_of(mesh, bodies, pose).move(new)
    surface = np.unique(mesh.facets[mesh.markers == 0])
    turned = np.array([[np.cos(0.2), 0, np.sin(0.2)], [0, 1, 0], [-np.sin(0.2), 0, np.cos(0.2)]])
    expected = mesh.points[surface] @ turned.T + [0.05, 0, -0.02]
    np.testing.assert_allclose(moved[surface], expected, atol=1e-14)
    assert np.all(cell_volumes(moved, mesh.cells) > 0)


@pytest.mark.parametrize("case", ["disk", "solid"])
def test_vertices_on_the_box_slide_on_their_faces_and_corners_stay(case, request):
    bodies, pose, mesh = request.getfixturevalue(case)
    moved = motion_of(mesh, bodies, pose).move(Pose(pose.position + 0.04, pose.orientation))
    on_faces = np.zeros(mesh.points.shape, dtype=bool)
    for face in range(2 * bodies[0].dimension):
        on_faces[np.unique(mesh.facets[mesh.markers == 1 + face]), face // 2] = True
    assert np.array_equal(moved[on_faces], mesh.points[on_faces])
    assert np.sum(np.all(on_faces, axis=1)) == 2 ** bodies[0].dimension
    assert np.abs(moved[on_faces.any(axis=1)] - mesh.points[on_faces.any(axis=1)]).max() > 1e-3


def test_free_vertices_are_in_balance(ellipse):
    bodies, pose, mesh = ellipse
    new = Pose(pose.position + [0.05, 0.1], pose.orientation + 0.1)
    moved = motion_of(mesh, bodies, pose).move(new)
    free = np.setdiff1d(np.arange(len(mesh.points)), mesh.facets)
    matrix = stiffness(mesh)
    residual = (matrix @ (moved - mesh.points))[free]
    assert np.abs(residual).max() < 1e-11 * np.abs(matrix.diagonal()).max()


def test_the_stiffness_weighs_each_cell_by_the_papers_tau():
    mesh = generate_mesh(FluidDomain([ball(0.125)], upright([1, 2]), BOX, ()), Sizes(0.4, 0.1, 0.5))
    field = mesh.points @ [0.3, -0.7]
    volume = cell_volumes(mesh.points, mesh.cells)
    weight = 1 + (1 - volume.min() / volume.max()) / (volume / volume.max())
    energy = field @ (stiffness(mesh) @ field)
    assert energy == pytest.approx(0.58 * np.sum(weight * volume), rel=1e-12)


def test_small_cells_keep_their_shape_better_than_large_ones(disk):
    bodies, pose, mesh = disk
    moved = motion_of(mesh, bodies, pose).move(Pose(pose.position - [0, 0.3], pose.orientation))
    edges = edges_of(mesh.cells)
    before, after = (np.linalg.norm(np.diff(p[edges], axis=1)[:, 0], axis=1) for p in (mesh.points, moved))
    strain = np.abs(after / before - 1)
    assert strain[before < 0.025].mean() < 0.3 * strain[before > 0.1].mean()


def test_a_box_without_bodies_stands_still():
    mesh = generate_mesh(FluidDomain([], nobody(2), BOX, ()), Sizes(0.4, 0.1, 0.5))
    assert np.array_equal(motion_of(mesh, [], nobody(2)).move(nobody(2)), mesh.points)


@pytest.mark.parametrize("case", ["ellipse", "solid"])
def test_a_mesh_in_parts_moves_as_the_whole_does(case, request):
    bodies, pose, mesh = request.getfixturevalue(case)
    new = Pose(pose.position + 0.03, upright(*pose.position).orientation)

    def moved(ranks):
        part = distributed(mesh if ranks.is_root else None, ranks)
        return part.part.vertices, motion_of(part, bodies, pose, OnTheRoot).move(new)

    expected = motion_of(mesh, bodies, pose).move(new)
    for vertices, points in on_ranks(9, moved):
        np.testing.assert_allclose(points, expected[vertices], rtol=0, atol=1e-13)


@pytest.mark.parametrize("case", ["ellipse", "solid"])
def test_a_part_s_vertices_are_held_where_the_facet_is_another_s(case, request):
    bodies, _, mesh = request.getfixturevalue(case)
    expected = held_components(mesh, len(bodies), domain_of(mesh))

    def held(ranks):
        part = distributed(mesh if ranks.is_root else None, ranks)
        return part.part.vertices, held_components(part, len(bodies), domain_of(part))

    for vertices, components in on_ranks(9, held):
        assert np.array_equal(components, expected[vertices])
