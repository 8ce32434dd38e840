"""The first mesh, from Netgen."""

from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import assert_valid, ball, body_facets, box, edge_lengths, edges_of, ellipsoid, nobody, upright

from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation import meshing
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import check_mesh
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import MeshError

LOWER, UPPER = np.zeros(2), np.array([2.0, 3.0])
LOW, HIGH = np.full(3, -1.0), np.array([1.0, 2.0, 1.0])
BOX, CUBE = box(LOWER, UPPER), box(LOW, HIGH)
DISK = ball(0.125)
TILTED = Pose(np.array([[0.9, 1.2]]), np.array([[0.7]]))
HALF_TURN = np.array([[np.cos(0.4), 0.0, 0.0, np.sin(0.4)]])

CASES_2D = [
    pytest.param([], nobody(2), id="box"),
    pytest.param([DISK], upright([1, 2]), id="disk"),
    pytest.param([ellipsoid(0.3, 0.1)], TILTED, id="ellipse"),
    pytest.param([DISK], upright([1, 0.125 * (1 + 1e-3)]), id="near-wall"),
    pytest.param([DISK] * 3, upright([1, 2], [1.25 * (1 + 1e-4), 2], [0.5, 0.5]), id="near-each-other"),
]
CASES_3D = [
    pytest.param([], nobody(3), id="box"),
    pytest.param([ball(0.4, 3)], upright([0, 0, 0.1]), id="sphere"),
    pytest.param([ellipsoid(0.5, 0.25, 0.3)], Pose(np.array([[0.0, 0.5, 0.0]]), HALF_TURN), id="ellipsoid"),
    pytest.param([ball(0.4, 3)], upright([0, 0.2, -0.599]), id="near-wall"),
]


@pytest.mark.parametrize(("bodies", "pose"), CASES_2D)
def test_a_plane_mesh_is_valid_silent_and_fine_on_the_bodies(bodies, pose, capfd):
    mesh = generate_mesh(FluidDomain(bodies, pose, BOX, ()), Sizes(0.2, 0.02, 0.2))
    assert capfd.readouterr() == ("", "")
    assert_valid(mesh, bodies, pose, LOWER, UPPER)
    edges = edges_of(mesh.facets[mesh.markers < len(bodies)])
    assert np.all(edge_lengths(mesh.points, edges) <= 0.02)
    area = np.prod(UPPER - LOWER) - sum(body.volume for body in bodies)
    assert cell_volumes(mesh.points, mesh.cells).sum() == pytest.approx(area, rel=1e-3)


@pytest.mark.parametrize(("bodies", "pose"), CASES_3D)
def test_a_mesh_in_space_is_valid_silent_and_fine_on_the_bodies(bodies, pose, capfd):
    mesh = generate_mesh(FluidDomain(bodies, pose, CUBE, ()), Sizes(0.6, 0.15, 0.4))
    assert capfd.readouterr() == ("", "")
    assert_valid(mesh, bodies, pose, LOW, HIGH)
    edges = edges_of(mesh.facets[mesh.markers < len(bodies)])
    assert np.all(edge_lengths(mesh.points, edges) <= 0.15)
    volume = np.prod(HIGH - LOW) - sum(body.volume for body in bodies)
    assert cell_volumes(mesh.points, mesh.cells).sum() == pytest.approx(volume, rel=5e-3)


def test_a_mesh_away_from_everything_has_good_cells():
    mesh = generate_mesh(FluidDomain([DISK], upright([1, 2]), BOX, ()), Sizes(0.2, 0.02, 0.2))
    assert cell_quality(mesh.points, mesh.cells).min() > 0.5


def test_the_same_input_gives_the_same_mesh_to_the_last_bit():
    first, second = (
        generate_mesh(FluidDomain([DISK], upright([1, 2]), BOX, ()), Sizes(0.2, 0.02, 0.2)) for _ in range(2)
    )
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.cells, second.cells)
    assert body_facets(first, 1) == body_facets(second, 1)


@pytest.mark.parametrize(
    ("bodies", "pose", "domain", "sizes"),
    [
        pytest.param([DISK], upright([1, 2]), BOX, (0.2, 0.01, 0.2), id="2D"),
        pytest.param([ball(0.4, 3)], upright([0, 0, 0.1]), CUBE, (0.6, 0.15, 0.4), id="3D"),
    ],
)
def test_surfaces_show_what_edges_to_ask_for_before_the_mesh_is_made(bodies, pose, domain, sizes, monkeypatch):
    run, asked = meshing.run_netgen, []

    def seen(*arguments, surfaces_alone=False):
        asked.append((surfaces_alone, float(arguments[2][0])))
        return run(*arguments, surfaces_alone=surfaces_alone)

    monkeypatch.setattr(meshing, "run_netgen", seen)
    mesh = generate_mesh(FluidDomain(bodies, pose, domain, ()), Sizes(*sizes))
    assert [alone for alone, _ in asked] == [True] * (len(asked) - 1) + [False]
    assert asked[0][1] == sizes[1] > asked[-1][1]
    edges = edges_of(mesh.facets[mesh.markers == 0])
    assert edge_lengths(mesh.points, edges).max() <= sizes[1]


@pytest.mark.parametrize(
    ("positions", "body"),
    [
        pytest.param([[1, 2], [1.1, 2]], 0, id="overlap"),
        pytest.param([[1, 2], [1, 2]], 1, id="one-inside-another"),
        pytest.param([[1, 2], [0.1, 2]], 1, id="through-a-wall"),
        pytest.param([[1, 2], [1, 3.5]], 1, id="outside"),
    ],
)
def test_an_impossible_geometry_is_refused_by_the_body_s_name(positions, body):
    with pytest.raises(MeshError, match=f"^body.{body}.position"):
        generate_mesh(FluidDomain([DISK, DISK], upright(*positions), BOX, ()), Sizes(0.2, 0.02, 0.2))


def test_a_mesh_with_an_unlisted_facet_is_refused():
    mesh = generate_mesh(FluidDomain([DISK], upright([1, 2]), BOX, ()), Sizes(0.2, 0.05, 0.2))
    with pytest.raises(MeshError, match="marked facets"):
        check_mesh(replace(mesh, facets=mesh.facets[1:], markers=mesh.markers[1:]), quality=0.0)
    inside = mesh.cells[np.isin(mesh.cells, mesh.facets).sum(axis=1) < 2][:1, :2]
    with pytest.raises(MeshError, match="marked facets"):
        check_mesh(replace(mesh, facets=np.concatenate([mesh.facets[1:], inside])), quality=0.0)


def test_a_mesh_with_a_bad_cell_is_refused_and_the_place_named():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.01]])
    edges = np.array([[0, 1], [0, 2], [1, 2]])
    sliver = Mesh(points, np.array([[0, 1, 2]]), edges, np.zeros(3, dtype=np.int64))
    check_mesh(sliver, quality=0.01)
    with pytest.raises(MeshError, match=r"^mesh near \[0.6667 0.0033\]: found a cell of quality 0.0173"):
        check_mesh(sliver, quality=0.02)


def test_a_body_that_the_mesher_takes_for_touching_is_told_how_far_to_go():
    """The floor is named, and with the gap that is asked for there is a mesh."""
    gap, least = 0.1 * 3e-7 * 3.0 / 8.0, 3e-7 * 3.0 / 8.0
    sizes, fine = Sizes(0.2, 0.05, growth=0.2), [(np.array([1.0, 0.0]), 1e-5)]
    with pytest.raises(MeshError, match=rf"contact with 'bottom'; allowed is a gap of more than {least:.2g} "):
        generate_mesh(FluidDomain([DISK], upright([1, 0.125 + gap]), BOX, ()), sizes)
    made = generate_mesh(FluidDomain([DISK], upright([1, 0.125 + 1.1 * least]), BOX, ()), sizes, fine)
    assert made.points[np.unique(made.facets[made.markers == 0]), 1].min() > 0.0
