"""Re-meshing around bodies that move towards walls and each other, and away again."""

from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import (
    assert_valid,
    ball,
    body_facets,
    box,
    box_walls,
    edge_lengths,
    edges_of,
    ellipsoid,
    nobody,
    upright,
)

from rigidfluid.core.mesh.adaptation import remesh as module
from rigidfluid.core.mesh.adaptation.first_mesh import initial_mesh
from rigidfluid.core.mesh.adaptation.kept_cells import LAYERS
from rigidfluid.core.mesh.adaptation.mesh_motion import MeshMotion
from rigidfluid.core.mesh.adaptation.mmg import without_unused
from rigidfluid.core.mesh.adaptation.remesh import remesh
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation import refine_surface as surface
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.generation.refine_films import refine_films
from rigidfluid.core.mesh.generation.refine_surface import long_edges, refine_surface
from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes
from rigidfluid.core.mesh.size.size_field import ALONG_FILM, LONGEST, Sizes, wanted_size
from rigidfluid.core.model.types import Mesh, Pose
from rigidfluid.errors import MeshError

LOWER, UPPER = np.zeros(2), np.array([2.0, 6.0])
BOX = box(LOWER, UPPER)
RADIUS, DISK = 0.125, ball(0.125)
FINE, COARSE = Sizes(size=0.15, size_body=0.01), Sizes(size=0.15, size_body=0.025)
APPROACH = np.geomspace(0.2, 5e-4, 60)
THERE_AND_BACK = np.concatenate([APPROACH, APPROACH[::-1]])


def bridges(mesh, bodies, first, others):
    """How many edges join one body directly to other surfaces, where both are closer than its facets are long."""
    edges = edges_of(mesh.cells)
    mine, theirs = (np.isin(edges, mesh.facets[np.isin(mesh.markers, which)]) for which in ([first], others))
    joins = (mine & theirs[:, ::-1]).any(axis=1)
    return int(np.sum(edge_lengths(mesh.points, edges[joins]) < 2e-2))


def drive(bodies, poses, gap, sizes, upper=UPPER):
    """Move along poses, re-mesh when a cell gets bad or the gap has halved; meshes made, with their pose and gap."""
    walls, domain = box_walls(LOWER, upper, len(bodies)), box(LOWER, upper)
    mesh, start = initial_mesh(FluidDomain(bodies, poses[0], domain, walls), sizes), poses[0]
    motion, made = MeshMotion(mesh, FluidDomain(bodies, start, domain, ())), [(mesh, start, gap(start))]
    for pose in poses[1:]:
        points = motion.move(pose)
        quality = cell_quality(points, mesh.cells).min()
        assert quality > 0.05
        if quality < 0.3 or (gap(pose) < 0.5 * made[-1][2] and gap(pose) < sizes.cells_per_gap * sizes.size_body):
            moved = Mesh(points, mesh.cells, mesh.facets, mesh.markers)
            mesh = remesh(moved, FluidDomain(bodies, pose, domain, walls), sizes, LAYERS)
            assert_valid(mesh, bodies, pose, LOWER, upper)
            unsplit = refine_surface(moved, FluidDomain(bodies, pose, domain, walls), sizes)
            assert body_facets(mesh, len(bodies)) == body_facets(unsplit, len(bodies))
            motion = MeshMotion(mesh, FluidDomain(bodies, pose, domain, ()))
            made.append((mesh, pose, gap(pose)))
    return made


def assert_good_and_bounded(made, most_cells):
    assert min(cell_quality(mesh.points, mesh.cells).min() for mesh, _, _ in made) > 0.3
    assert max(len(mesh.cells) for mesh, _, _ in made) < most_cells


@pytest.mark.parametrize(("sizes", "most_cells"), [(FINE, 3600), (COARSE, 2700)])
def test_a_disk_falls_to_the_wall_and_leaves_it(sizes, most_cells):
    poses = [upright([1, RADIUS + gap]) for gap in THERE_AND_BACK]
    made = drive([DISK], poses, lambda pose: pose.position[0, 1] - RADIUS, sizes)
    assert_good_and_bounded(made, most_cells)
    assert min(gap for _, _, gap in made) < 1.2e-3
    assert all(bridges(mesh, 1, 0, [3]) == 0 for mesh, _, _ in made)
    assert len(made) < 20


def test_two_disks_meet_and_part():
    poses = [upright([1 - RADIUS - gap / 2, 3], [1 + RADIUS + gap / 2, 3]) for gap in THERE_AND_BACK]
    made = drive([DISK, DISK], poses, lambda pose: np.diff(pose.position[:, 0])[0] - 2 * RADIUS, FINE)
    assert_good_and_bounded(made, 5600)
    assert min(gap for _, _, gap in made) < 1.2e-3
    assert all(bridges(mesh, 2, 0, [1]) == 0 for mesh, _, _ in made)


def test_an_ellipse_turns_near_a_wall():
    def lowest(pose):
        return pose.position[0, 1] - np.hypot(
            0.1 * np.sin(pose.orientation[0, 0]), 0.05 * np.cos(pose.orientation[0, 0])
        )

    poses = [Pose(np.array([[1.0, 0.102]]), np.array([[angle]])) for angle in np.linspace(0, 2 * np.pi, 160)]
    made = drive([ellipsoid(0.1, 0.05)], poses, lowest, FINE, np.array([2.0, 2.0]))
    assert_good_and_bounded(made, 2200)
    assert min(gap for _, _, gap in made) < 4.2e-3
    assert all(bridges(mesh, 1, 0, [3]) == 0 for mesh, _, _ in made)


def test_the_cells_grow_again_after_the_wall_is_left_but_the_kept_facets_stay():
    poses = [upright([1, RADIUS + gap]) for gap in THERE_AND_BACK]
    made = drive([DISK], poses, lambda pose: pose.position[0, 1] - RADIUS, FINE)
    facets = [np.sum(mesh.markers == 0) for mesh, _, _ in made]
    wall = [np.sum(mesh.markers == 3) for mesh, _, _ in made]
    assert np.all(np.diff(facets) >= 0)
    assert wall[-1] < 0.5 * max(wall)


def test_a_sphere_moves_towards_a_wall_in_space():
    lower, upper, body, sizes = np.full(3, -1.0), np.ones(3), ball(0.4, 3), Sizes(0.6, 0.2, growth=0.4)
    walls, cube = box_walls(lower, upper, 1), box(lower, upper)
    mesh = initial_mesh(FluidDomain([body], upright([0, 0, 0]), cube, walls), sizes)
    assert_valid(mesh, [body], upright([0, 0, 0]), lower, upper)
    pose = upright([0, 0, -0.3])
    moved = replace(mesh, points=MeshMotion(mesh, FluidDomain([body], upright([0, 0, 0]), cube, ())).move(pose))
    halfway = remesh(moved, FluidDomain([body], pose, cube, walls), sizes)
    assert_valid(halfway, [body], pose, lower, upper)
    assert body_facets(halfway, 1) == body_facets(moved, 1)
    near = upright([0, 0, -0.45])
    moved = replace(halfway, points=MeshMotion(halfway, FluidDomain([body], pose, cube, ())).move(near))
    split = remesh(moved, FluidDomain([body], near, cube, walls), sizes)
    assert_valid(split, [body], near, lower, upper)
    assert np.sum(split.markers == 0) > np.sum(moved.markers == 0)
    assert cell_quality(split.points, split.cells).min() > 0.15


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_box_without_bodies_is_meshed(dimension):
    lower, upper = np.zeros(dimension), np.ones(dimension)
    walls = box_walls(lower, upper, 0)
    mesh = initial_mesh(FluidDomain([], nobody(dimension), box(lower, upper), walls), Sizes(0.3, 0.1))
    assert_valid(mesh, [], nobody(dimension), lower, upper)


@pytest.mark.parametrize("gap", [1e-3, 1.25e-4])
@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("shift", [0.0, 0.003, 0.011])
def test_a_narrow_gap_is_resolved_from_the_start(gap, count, shift):
    alone, pair = upright([1 + shift, RADIUS + gap]), upright([1 + shift, 3], [1 + shift + 2 * RADIUS + gap, 3])
    bodies, pose = [DISK] * count, alone if count == 1 else pair
    mesh = initial_mesh(FluidDomain(bodies, pose, BOX, box_walls(LOWER, UPPER, count)), COARSE)
    assert_valid(mesh, bodies, pose, LOWER, UPPER)
    assert bridges(mesh, count, 0, [3 if count == 1 else 1]) == 0 or gap < 2 * COARSE.smallest
    assert cell_quality(mesh.points, mesh.cells).min() > (0.3 if gap > 2 * COARSE.smallest else 0.1)


def test_only_edges_too_long_for_the_gap_are_split_and_their_middles_lie_on_the_surface():
    pose, walls = upright([1, RADIUS + 2e-3]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.01, 0.2))
    split = refine_surface(mesh, FluidDomain([DISK], pose, BOX, walls), FINE)
    assert np.array_equal(split.points[: len(mesh.points)], mesh.points)
    edges = np.sort(split.facets[split.markers == 0], axis=1)
    wanted = wanted_size(split.points[edges].mean(axis=1), FluidDomain([DISK], pose, BOX, walls), FINE)
    assert np.all(edge_lengths(split.points, edges) <= 1.5 * wanted)
    upper_half = {facet for facet in body_facets(mesh, 1) if min(point[1] for point in facet[1]) > RADIUS}
    assert upper_half <= body_facets(split, 1)
    assert np.all(cell_volumes(split.points, split.cells) > 0)


def test_edges_across_a_film_thinner_than_its_cells_are_split_inside_and_elsewhere_they_stay():
    pose = upright([1 - RADIUS - 2e-5, 3], [1 + RADIUS + 2e-5, 3])
    around = FluidDomain([DISK] * 2, pose, BOX, box_walls(LOWER, UPPER, 2))
    mesh = refine_surface(generate_mesh(around, COARSE), around, COARSE)
    split = refine_films(mesh, around, COARSE)
    film = np.linalg.norm(mesh.points[mesh.cells].mean(axis=1) - [1.0, 3.0], axis=1) < 0.1
    before, after = (inner_edges_in_film(one, around) for one in (mesh, split))
    assert before.max() > 2 * LONGEST
    assert after.max() <= LONGEST
    assert np.array_equal(split.facets, mesh.facets)
    assert np.array_equal(split.points[: len(mesh.points)], mesh.points)
    assert {tuple(cell) for cell in mesh.cells[~film].tolist()} <= {tuple(cell) for cell in split.cells.tolist()}
    assert np.all(cell_volumes(split.points, split.cells) > 0)


def inner_edges_in_film(mesh, around):
    """Lengths of inner edges over the wanted size where the film is thinner than that."""
    edges = np.array(sorted(set(map(tuple, edges_of(mesh.cells))) - set(map(tuple, np.sort(mesh.facets, axis=1)))))
    middles = mesh.points[edges].mean(axis=1)
    wanted = wanted_size(middles, around, COARSE)
    return (edge_lengths(mesh.points, edges) / wanted)[around.gap_widths(middles) < wanted]


@pytest.mark.long
@pytest.mark.nightly
def test_two_balls_are_meshed_at_a_gap_of_a_twenty_thousandth_of_their_radius():
    lower, upper, sizes = np.full(3, -3.0), np.full(3, 3.0), Sizes(1.5, 0.4, 0.5, refinements=5)
    pose = upright([0, 0, -1.000025], [0, 0, 1.000025])
    bodies = [ball(1.0, 3)] * 2
    mesh = initial_mesh(FluidDomain(bodies, pose, box(lower, upper), box_walls(lower, upper, 2)), sizes)
    assert_valid(mesh, bodies, pose, lower, upper)
    assert cell_quality(mesh.points, mesh.cells).min() > 0.02


def test_the_wanted_size_follows_its_formula():
    pose, walls = upright([1, RADIUS + 2e-3]), box_walls(LOWER, UPPER, 1)
    points = np.array([[1.0, 2 * RADIUS + 2e-3], [1.0, 0.9], [1.0, 5.9], [1.0, 1e-3], [1.1, 0.0]])
    beside = np.hypot(0.1, RADIUS + 2e-3) - RADIUS
    expected = [0.01, 0.01 + 0.2 * (0.9 - 2 * RADIUS - 2e-3), 0.15, 1e-3, 0.01 + 0.2 * beside]
    np.testing.assert_allclose(wanted_size(points, FluidDomain([DISK], pose, BOX, walls), FINE), expected, rtol=1e-12)
    closest = wanted_size(np.array([[1.0, 0.0]]), FluidDomain([DISK], upright([1, RADIUS + 1e-6]), BOX, walls), FINE)
    assert closest == pytest.approx(ALONG_FILM * np.sqrt(RADIUS * 1e-6), rel=1e-6)
    assert 0.01 / 64 / 8 < closest < 0.01 / 64


def test_two_bodies_make_a_gap_and_walls_that_do_not_repel_make_none():
    pair, between = upright([1, 3], [1.251, 3]), np.array([[1.1255, 3.0]])
    assert wanted_size(between, FluidDomain([DISK] * 2, pair, BOX, []), FINE) == pytest.approx(5e-4, rel=1e-9)
    near_wall = upright([1, RADIUS + 2e-3])
    assert wanted_size(np.array([[1.0, 1e-3]]), FluidDomain([DISK], near_wall, BOX, []), FINE) > 0.01


def test_the_same_input_gives_the_same_mesh_to_the_last_bit():
    pose, walls = upright([1, RADIUS + 0.01]), box_walls(LOWER, UPPER, 1)
    first, second = (initial_mesh(FluidDomain([DISK], pose, BOX, walls), FINE) for _ in range(2))
    assert np.array_equal(first.points, second.points)
    assert np.array_equal(first.cells, second.cells)


def spoil_lose_a_facet(mesh):
    return replace(mesh, cells=mesh.cells[np.sum(np.isin(mesh.cells, mesh.facets[0]), axis=1) < 2])


def spoil_move_a_body_vertex(mesh):
    points = mesh.points.copy()
    points[mesh.facets[mesh.markers == 0][0, 0]] += 1e-5
    return replace(mesh, points=points)


def spoil_invert_a_cell(mesh):
    inside = np.setdiff1d(mesh.cells, mesh.facets)[0]
    points = mesh.points.copy()
    points[inside] += 1.0
    return replace(mesh, points=points)


def spoil_take_a_wall_for_another(mesh):
    markers = mesh.markers.copy()
    markers[np.flatnonzero(markers == 3)[5]] = 1
    return replace(mesh, markers=markers)


SPOILERS = [spoil_lose_a_facet, spoil_move_a_body_vertex, spoil_invert_a_cell, spoil_take_a_wall_for_another]


@pytest.mark.parametrize("spoil", SPOILERS)
def test_a_mesh_that_mmg_has_spoilt_is_refused(spoil, monkeypatch):
    pose, walls = upright([1, 1]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.025, 0.2))
    good = module.run_mmg
    monkeypatch.setattr(module, "run_mmg", lambda *arguments: spoil(good(*arguments)))
    with pytest.raises(MeshError):
        remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)


def test_a_lost_corner_of_the_box_is_seen_by_the_volume(monkeypatch):
    pose, walls = upright([1, 1]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.025, 0.2))
    good = module.run_mmg

    def without_corner(*arguments):
        made = good(*arguments)
        made.points[np.argmin(np.linalg.norm(made.points, axis=1))] += [0.0, 1e-6]
        return made

    monkeypatch.setattr(module, "run_mmg", without_corner)
    monkeypatch.setattr(module, "put_back", lambda mesh, *_, **__: mesh)
    with pytest.raises(MeshError, match="volume"):
        remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)


def test_an_mmg_that_does_nothing_is_refused(monkeypatch):
    pose, walls = upright([1, RADIUS + 2e-3]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.025, 0.2))
    monkeypatch.setattr(module, "run_mmg", lambda mesh, *_: mesh)
    with pytest.raises(MeshError):
        remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)


def with_a_vertex_below_the_surface():
    """A disk near the floor, with a vertex added between a facet and the disk's arc above it; and that facet."""
    pose, walls = upright([1, RADIUS + 0.02]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.025, 0.2))
    edges, middles, _ = long_edges(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE, 1.5)
    added = 0.5 * (middles[0] + mesh.points[edges[0]].mean(axis=0))
    split = np.flatnonzero(np.isin(mesh.cells, edges[0]).sum(axis=1) == 2)
    assert len(split) == 1
    cells = np.repeat(mesh.cells[split], 3, axis=0)
    np.fill_diagonal(cells, len(mesh.points))
    points = np.vstack([mesh.points, added])
    mesh = replace(mesh, points=points, cells=np.vstack([np.delete(mesh.cells, split, axis=0), cells]))
    return mesh, pose, walls, edges[0]


def test_a_bisection_that_would_invert_a_cell_waits_for_better_cells():
    mesh, pose, walls, edge = with_a_vertex_below_the_surface()
    assert cell_volumes(mesh.points, mesh.cells).min() > 0
    refined = refine_surface(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)
    assert cell_volumes(refined.points, refined.cells).min() > 0
    assert len(refined.points) > len(mesh.points)
    left, _, _ = long_edges(refined, FluidDomain([DISK], pose, BOX, walls), COARSE, 1.5)
    assert left.tolist() == [edge.tolist()]
    new = remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)
    assert_valid(new, [DISK], pose, LOWER, UPPER)
    assert not len(long_edges(new, FluidDomain([DISK], pose, BOX, walls), COARSE, 1.5)[0])


def test_edges_that_never_fit_stay(monkeypatch):
    mesh, pose, walls, _ = with_a_vertex_below_the_surface()
    tried = []
    monkeypatch.setattr(surface, "spares_cells", lambda _, edges, __: tried.append(1) or np.zeros(len(edges), bool))
    new = remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE)
    assert len(tried) >= module.ROUNDS
    assert body_facets(new, 1) == body_facets(mesh, 1)


def test_mmg_gets_a_second_chance_with_another_gradation(monkeypatch):
    pose, walls = upright([1, 1]), box_walls(LOWER, UPPER, 1)
    mesh = generate_mesh(FluidDomain([DISK], pose, BOX, ()), Sizes(0.15, 0.025, 0.2))
    good, gradations = module.run_mmg, []

    def fails_once(*arguments):
        gradations.append(arguments[-1])
        made = good(*arguments)
        return spoil_lose_a_facet(made) if len(gradations) == 1 else made

    monkeypatch.setattr(module, "run_mmg", fails_once)
    assert_valid(remesh(mesh, FluidDomain([DISK], pose, BOX, walls), COARSE), [DISK], pose, LOWER, UPPER)
    assert len(set(gradations)) == 2


def test_a_vertex_that_no_cell_has_is_left_out():
    points, cells = np.array([[0.0, 0.0], [9.0, 9.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 2, 3]])
    mesh = without_unused(Mesh(points, cells, np.array([[2, 3]]), np.array([0])))
    np.testing.assert_array_equal(mesh.points, points[[0, 2, 3]])
    np.testing.assert_array_equal(mesh.cells, [[0, 1, 2]])
    np.testing.assert_array_equal(mesh.facets, [[1, 2]])
