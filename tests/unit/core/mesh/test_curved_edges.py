"""Edges on bodies and curved walls, bent onto the exact surface."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest
from dish import dish
from falling import falling_disk
from mesh_tools import ball, ellipsoid, upright
from scipy.spatial import Delaunay

from rigidfluid.backends.scikit_fem import ScikitFem
from rigidfluid.core.geometry.quadratic_cells import quadratic_basis
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.distribution import partition, parts_of, whole
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.curved_cells import CurvedCells
from rigidfluid.core.mesh.generation.curved_edges import SQUEEZED, with_curved_edges
from rigidfluid.core.mesh.location import locate
from rigidfluid.core.mesh.mesh_quality import cell_quality
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import boundary_facets, orient
from rigidfluid.core.model.types import CurvedEdges, Mesh, Pose
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.domains.box import Box, BoxOptions
from rigidfluid.taylor_hood.elements.location import locate_on_curves
from rigidfluid.taylor_hood.elements.numbering import Numbering


def curved_mesh(body, pose, domain, size=0.2, size_body=0.1):
    mesh = initial_mesh(FluidDomain([body], pose, domain, ()), Sizes(size, size_body))
    return with_curved_edges(mesh, FluidDomain([body], pose, domain, ()))


@pytest.fixture(scope="module", params=[2, 3])
def around_an_ellipsoid(request):
    d = request.param
    box = Box(BoxOptions(lower=(-1.0,) * d, upper=(1.0,) * d), d)
    body, pose = ellipsoid(*(0.5, 0.3, 0.3)[:d]), upright([0.1, 0.0, 0.0][:d])
    return body, pose, box, curved_mesh(body, pose, box, 0.4, 0.15 if d == 2 else 0.25)


def test_all_edges_on_a_body_pass_through_its_surface(around_an_ellipsoid) -> None:
    body, pose, _, mesh = around_an_ellipsoid
    facets = mesh.facets[mesh.markers == 0]
    pairs = [list(pair) for pair in combinations(range(facets.shape[1]), 2)]
    edges = np.unique(np.sort(np.concatenate([facets[:, pair] for pair in pairs]), axis=1), axis=0)
    assert np.array_equal(mesh.curved.vertices, edges)
    assert np.all(mesh.curved.surface == 0)
    np.testing.assert_allclose(body.signed_distance(mesh.curved.middles - pose.position[0]), 0.0, atol=1e-9)


def test_nodes_on_other_edges_are_half_way(around_an_ellipsoid) -> None:
    *_, mesh = around_an_ellipsoid
    numbering = Numbering.from_mesh(mesh)
    nodes, straight = numbering.node_points(mesh.geometry), numbering.interpolate_to_nodes(mesh.points)
    np.testing.assert_array_equal(nodes[numbering.on_curves], mesh.curved.middles)
    others = np.setdiff1d(np.arange(numbering.nodes), numbering.on_curves)
    np.testing.assert_array_equal(nodes[others], straight[others])
    np.testing.assert_array_equal(
        numbering.curved_cell_points(mesh.geometry), nodes[numbering.cell_nodes[numbering.curved_cells]]
    )


def test_curved_edges_move_rigidly_with_their_body(around_an_ellipsoid) -> None:
    body, pose, box, mesh = around_an_ellipsoid
    half = 0.05
    turn = np.array([0.1]) if len(pose.position[0]) == 2 else np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
    there = Pose(pose.position + 0.03, turn[None])
    moved = mesh.moved_to(MeshMotion(mesh, FluidDomain([body], pose, box, ())).move(there))
    cosine, sine = np.cos(0.1), np.sin(0.1)
    rotation = np.eye(len(pose.position[0]))
    rotation[:2, :2] = [[cosine, -sine], [sine, cosine]]
    expected = (mesh.curved.middles - pose.position[0]) @ rotation.T + there.position[0]
    np.testing.assert_allclose(moved.curved.middles, expected, atol=1e-13)


@pytest.mark.long
def test_the_cells_volumes_are_the_domains_less_the_bodys(around_an_ellipsoid) -> None:
    """By the determinant of the quadratic map; straight cells have ten times the error."""
    body, _, _, mesh = around_an_ellipsoid
    d = mesh.points.shape[1]
    exact = 2.0**d - body.volume
    found = {}
    for kind, each in (("curved", mesh), ("straight", replace(mesh, curved=None))):
        numbering = Numbering.from_mesh(each)
        posed = np.ones((numbering.nodes, d))
        assembly = ScikitFem.assembly(None, numbering)  # type: ignore[arg-type]
        found[kind] = abs(assembly.mass_times(each.geometry, posed)[:, 0].sum() / exact - 1.0)
    assert found["curved"] < 0.1 * found["straight"], found


def test_the_least_jacobian_is_that_of_the_quadratic_map(around_an_ellipsoid) -> None:
    *_, mesh = around_an_ellipsoid
    cells, d = CurvedCells(mesh), mesh.points.shape[1]
    numbering = Numbering.from_mesh(mesh)
    np.testing.assert_array_equal(cells.cells, mesh.cells[numbering.curved_cells])
    nodes = numbering.curved_cell_points(mesh.geometry)
    at = np.vstack([np.eye(d + 1), [np.eye(d + 1)[list(pair)].mean(axis=0) for pair in combinations(range(d + 1), 2)]])
    step = 1e-6 * np.hstack([-np.ones((d, 1)), np.eye(d)])
    slopes = [
        np.stack(
            [np.einsum("qb,cbi->cqi", quadratic_basis(at + s) - quadratic_basis(at - s), nodes) / 2e-6 for s in step],
            axis=-1,
        )
    ][0]
    flat = np.linalg.det(np.swapaxes(nodes[:, 1 : d + 1] - nodes[:, :1], 1, 2))
    expected = (np.linalg.det(slopes) / flat[:, None]).min(axis=1)
    np.testing.assert_allclose(cells.least_jacobian(mesh.geometry), expected, rtol=1e-7)
    assert expected.min() > SQUEEZED


def test_a_cell_too_thin_to_bend_stays_straight() -> None:
    """Over the long facet of a coarse disk a vertex in the way of the arc; the other edges bend."""
    disk, pose = ball(1.0, 2), upright([0.0, 0.0])
    angle = 2.0 * np.pi * np.arange(6) / 6
    ring = np.column_stack([np.cos(angle), np.sin(angle)])
    top = 1.25 * (ring + np.roll(ring, -1, axis=0))
    top[0] *= 0.48  # the arc passes at 1.155 of the chord's middle
    inner, outer = np.arange(6), 6 + np.arange(6)
    cells = np.concatenate(
        [
            np.column_stack([inner, np.roll(inner, -1), outer]),
            np.column_stack([outer, np.roll(outer, -1), np.roll(inner, -1)]),
        ]
    )
    facets = np.concatenate([np.column_stack([c, np.roll(c, -1)]) for c in (inner, outer)])
    mesh = orient(Mesh(np.concatenate([ring, top]), cells, facets, np.repeat([0, 1], 6)))
    box = Box(BoxOptions(lower=(-30.0, -30.0), upper=(30.0, 30.0)), 2)  # no gap
    curved = with_curved_edges(mesh, FluidDomain([disk], pose, box, ())).curved
    assert curved is not None
    assert curved.vertices.tolist() == [[0, 5], [1, 2], [2, 3], [3, 4], [4, 5]]


def test_edges_in_a_gap_stay_straight_before_it_halves() -> None:
    """A cell over a coarse disk keeps .56 of its volume: enough alone, too little where a wall is above it."""
    disk, pose = ball(1.0, 2), upright([0.0, 0.0])
    points = np.array([[-0.5, 0.75**0.5], [0.5, 0.75**0.5], [0.0, 1.48]])
    mesh = orient(Mesh(points, np.array([[0, 1, 2]]), np.array([[0, 1], [1, 2], [0, 2]]), np.array([0, 4, 4])))
    for height, bent in ((9.0, True), (1.5, False)):
        box = Box(BoxOptions(lower=(-9.0, -9.0), upper=(9.0, height)), 2)
        assert (with_curved_edges(mesh, FluidDomain([disk], pose, box, ())).curved is not None) == bent


def test_edges_of_poor_cells_stay_straight() -> None:
    """Bending leaves either cell over a ball .54 of its volume, no wall is near, and its apex is held; of the quality
    it leaves .24 over the one facet, and .14 over the narrower one."""
    box = Box(BoxOptions(lower=(-9.0,) * 3, upper=(9.0,) * 3), 3)
    facets, markers = np.array([[0, 1, 2], [3, 4, 5]]), np.array([0, 6])
    for width, bent in ((0.12, True), (0.05, False)):
        on_ball = np.array([[-0.4, 0.0, 1.0], [0.4, 0.0, 1.0], [0.0, width, 1.0]])
        on_ball /= np.linalg.norm(on_ball, axis=1, keepdims=True)
        middle = on_ball.mean(axis=0)
        apex = middle + 0.25 * middle / np.linalg.norm(middle)
        points = np.vstack([on_ball, apex, [[9.0, 9.0, 8.0], [9.0, 8.0, 9.0]]])
        mesh = orient(Mesh(points, np.array([[0, 1, 2, 3]]), facets, markers))
        assert (
            with_curved_edges(mesh, FluidDomain([ball(1.0, 3)], upright([0.0, 0.0, 0.0]), box, ())).curved is not None
        ) == bent


def test_vertices_that_gave_way_to_edges_come_back_where_these_stay_straight() -> None:
    """Around an octahedron for a ball no edge can bend, and cells half as good as the straight ones are left."""
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    octahedron = np.concatenate([np.eye(3), -np.eye(3)])
    points = np.concatenate([octahedron, 1.5 * corners / 3**0.5, 3.0 * corners, 3.0 * octahedron])
    cells = Delaunay(points).simplices.astype(np.int64)
    cells = cells[(cells >= len(octahedron)).any(axis=1)]
    facets = boundary_facets(cells)
    middles = points[facets].mean(axis=1)
    across = np.abs(middles).argmax(axis=1)
    wall = 1 + 2 * across + (np.take_along_axis(middles, across[:, None], axis=1)[:, 0] > 0.0)
    markers = np.where((facets < len(octahedron)).all(axis=1), 0, wall)
    box = Box(BoxOptions(lower=(-3.0,) * 3, upper=(3.0,) * 3), 3)
    mesh = with_curved_edges(
        orient(Mesh(points, cells, facets, markers)), FluidDomain([ball(1.0, 3)], upright([0.0, 0.0, 0.0]), box, ())
    )
    assert mesh.curved is None
    assert cell_quality(mesh.points, mesh.cells).min() > 0.3


def test_edges_on_a_curved_wall_bend_outwards() -> None:
    round_dish = dish(1.0)
    mesh = curved_mesh(ball(0.3, 2), upright([0.2, 0.1]), round_dish)
    on_rim = mesh.curved.surface == 1
    assert on_rim.sum() == np.sum(mesh.markers == 1)
    np.testing.assert_allclose(np.linalg.norm(mesh.curved.middles[on_rim], axis=1), 1.0, atol=1e-12)


def test_points_are_found_in_curved_cells(around_an_ellipsoid) -> None:
    """Whichever straight cell they seem to be in."""
    *_, mesh = around_an_ellipsoid
    numbering, d = Numbering.from_mesh(mesh), mesh.points.shape[1]
    nodes = numbering.curved_cell_points(mesh.geometry)
    inside = np.random.default_rng(0).dirichlet(np.ones(d + 1), size=len(nodes))
    targets = np.einsum("cb,cbi->ci", quadratic_basis(inside), nodes)
    seeming, _ = locate(mesh.points, mesh.cells, targets)
    known = np.isin(seeming, numbering.curved_cells)
    guess = np.searchsorted(numbering.curved_cells, seeming[known])
    cell, coordinates = locate_on_curves(nodes, guess, targets[known])
    assert np.array_equal(cell, np.flatnonzero(known))
    np.testing.assert_allclose(coordinates, inside[known], atol=1e-10)
    assert known.mean() > 0.9


def test_parts_of_a_mesh_hold_the_curved_edges_of_their_cells(around_an_ellipsoid) -> None:
    *_, mesh = around_an_ellipsoid
    bent = set(map(tuple, mesh.curved.vertices.tolist()))
    for part in parts_of(mesh, partition(mesh, 3)):
        number = part.part.vertices
        pairs = np.sort(part.cells[:, list(combinations(range(part.cells.shape[1]), 2))].reshape(-1, 2), axis=1)
        expected = bent & set(map(tuple, number[pairs].tolist()))
        curved = part.curved or CurvedEdges(np.zeros((0, 2), dtype=np.int64), np.zeros(0), np.zeros((0, 2)))
        assert set(map(tuple, number[curved.vertices].tolist())) == expected
        for edge, middle in zip(number[curved.vertices].tolist(), curved.middles, strict=True):
            place = mesh.curved.vertices.tolist().index(edge)
            assert np.array_equal(middle, mesh.curved.middles[place])
    assert whole(mesh) is mesh


@pytest.mark.parametrize(("order", "takes", "curved"), [(2, True, True), (1, True, False), (2, False, False)])
def test_cells_curve_where_the_scene_and_the_backend_have_it(monkeypatch, order, takes, curved) -> None:
    monkeypatch.setattr(ScikitFem, "curved_cells", takes)
    run = Simulation(falling_disk(mesh={"size": 0.3, "size_body": 0.05, "order": order}))
    assert (run.state.mesh.curved is not None) is curved
