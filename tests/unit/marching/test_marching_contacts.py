from dataclasses import replace

import numpy as np
import pytest
from marching_meshes import naive_distances, stars
from mesh_tools import ball, box, box_walls, random_ellipsoids, upright
from numba import njit

from rigidfluid.core.geometry.simplices import facet_to_facet
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.mesh.topology import boundary_facets
from rigidfluid.core.model.types import Contacts, Mesh
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.errors import SceneError
from rigidfluid.marching.contacts import Field
from rigidfluid.marching.exact import measure
from rigidfluid.marching.field import WAVES, Band
from rigidfluid.marching.pairs import facet_gaps
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import new_workspace

REACH = 0.25


def narrow_band(bodies, walls, **options):
    return NarrowBandDetector(NarrowBandOptions(**options), bodies, walls)


def naive_gap(mesh, a, b):
    """Least distance over all pairs of facets of two surfaces."""
    first, second = np.flatnonzero(mesh.markers == a), np.flatnonzero(mesh.markers == b)
    return least(mesh.points, mesh.facets, first, second)


@njit
def least(points, facets, first, second):
    square = np.inf
    for i in first:
        for j in second:
            square = min(square, facet_to_facet(points, facets, i, j)[0])
    return np.sqrt(square)


@pytest.mark.parametrize("accuracy", ["exact", "first-order"])
@pytest.mark.parametrize(("dimension", "seeds"), [(2, 20), (3, 4)])
def test_gaps_from_ragged_stars_are_those_of_all_pairs_of_facets(dimension, seeds, accuracy):
    found = 0
    for number in range(seeds):
        mesh, _ = stars(dimension, number)
        topology, work = Topology.from_mesh(mesh), new_workspace(len(mesh.points))
        star = topology.facets_of(0)
        wave = WAVES[accuracy](topology, mesh.points, [0], Band(np.inf), work)
        if accuracy == "first-order":
            measure(wave.target, work, wave.touched)
        others = np.flatnonzero(mesh.markers != 0).astype(np.int32)
        ball = np.zeros(dimension), np.inf
        gap, _ = facet_gaps(Field(0, wave.target, work), ball, others, np.inf, True)
        for row in np.flatnonzero(np.isfinite(gap)):
            assert gap[row] == pytest.approx(
                least(mesh.points, topology.surfaces.facets, others[row : row + 1], star), rel=1e-12
            )
            found += 1
    assert found > 20 * seeds


@pytest.fixture(scope="module", params=[(2, 0), (2, 1), (2, 2), (3, 0)], ids=str)
def ellipsoids(request):
    return random_ellipsoids(*request.param)


@pytest.mark.parametrize("accuracy", ["exact", "first-order"])
def test_gaps_are_those_of_all_pairs_of_facets(ellipsoids, accuracy):
    bodies, walls, pose, mesh = ellipsoids
    contacts = narrow_band(bodies, walls, accuracy=accuracy).detect(pose, mesh, REACH)
    found = dict(zip(zip(contacts.body_a, contacts.body_b, strict=True), contacts.gap, strict=True))
    surfaces = len(bodies) + len(walls)
    pairs = [(a, b) for a in range(len(bodies)) for b in range(a + 1, surfaces)]
    near = {pair: gap for pair in pairs if (gap := naive_gap(mesh, *pair)) <= REACH}
    assert list(found) == list(near)
    np.testing.assert_allclose(list(found.values()), list(near.values()), rtol=1e-12)


def test_contact_points_are_on_the_facets(ellipsoids):
    bodies, walls, pose, mesh = ellipsoids
    contacts = narrow_band(bodies, walls).detect(pose, mesh, REACH)
    for surfaces, points in ((contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)):
        for surface, point in zip(surfaces, points, strict=True):
            assert naive_distances(point[None], mesh.points, mesh.facets[mesh.markers == surface])[0] < 1e-12


def test_the_whole_domain_gives_the_same_contacts(ellipsoids):
    bodies, walls, pose, mesh = ellipsoids
    band = narrow_band(bodies, walls).detect(pose, mesh, REACH)
    whole = FastMarchingDetector(FastMarchingDetector.Options(), bodies, walls).detect(pose, mesh, REACH)
    np.testing.assert_allclose(whole.gap, band.gap, rtol=1e-14)


def test_threads_give_the_same_bits(ellipsoids):
    bodies, walls, pose, mesh = ellipsoids
    one, many = (narrow_band(bodies, walls, threads=count).detect(pose, mesh, REACH) for count in (1, 3))
    for name in Contacts.__slots__:
        np.testing.assert_array_equal(getattr(one, name), getattr(many, name))


def test_a_detector_goes_on_with_a_mesh_that_moves_and_with_another():
    bodies, walls = [ball(0.3)], box_walls(np.zeros(2), np.ones(2), 1)
    detector, pose = narrow_band(bodies, walls), upright([0.5, 0.5])
    mesh = generate_mesh(FluidDomain(bodies, pose, box(np.zeros(2), np.ones(2)), ()), Sizes(0.2, 0.02, 0.5))
    outside = np.clip((np.linalg.norm(mesh.points - 0.5, axis=1) - 0.3) / 0.2, 0.0, 1.0)
    moved = replace(mesh, points=mesh.points + np.outer(1.0 - outside, [0.0, 0.05]))
    finer = generate_mesh(FluidDomain(bodies, pose, box(np.zeros(2), np.ones(2)), ()), Sizes(0.1, 0.01, 0.5))
    places = [(pose, mesh), (upright([0.5, 0.55]), moved), (pose, finer)]
    gaps = [detector.detect(*place, np.inf).gap for place in places]
    np.testing.assert_allclose(gaps, [[0.2] * 4, [0.2, 0.2, 0.25, 0.15], [0.2] * 4], atol=1e-3)


def fork():
    """A body like a U over a floor, from squares: two feet, equally near, and a high bridge between them."""
    width, height = 11, 6
    solid = {(x, y) for x in range(2, 9) for y in range(2, 5) if y > 3 or x in (2, 3, 7, 8)}
    squares = [(x, y) for x in range(width) for y in range(height) if (x, y) not in solid]
    corners = sorted({(x + i, y + j) for x, y in squares for i in (0, 1) for j in (0, 1)})
    number = {corner: k for k, corner in enumerate(corners)}
    cells = [
        [number[x, y], number[x + 1, y + k], number[x + 1 - k, y + 1]] for x, y in squares for k in (0, 1)
    ]  # fmt: skip
    points, cells = np.array(corners, float), np.array(cells)
    facets = boundary_facets(cells)
    middle = points[facets].mean(axis=1)
    inside = np.all((middle > 0) & (middle < [width, height]), axis=1)
    floor = middle[:, 1] == 0
    return Mesh(points, cells, facets, np.where(inside, 0, np.where(floor, 3, 1)))


def test_a_fork_touches_the_floor_at_both_feet():
    mesh, body = fork(), ball(4.0)
    pose, floor = upright([5.5, 3.5]), box_walls(np.zeros(2), np.array([11.0, 6.0]), 1)[2]
    single = narrow_band([body], [floor]).detect(pose, mesh, 2.2)
    several = narrow_band([body], [floor], multiple=True).detect(pose, mesh, 2.2)
    assert len(single) == 1
    np.testing.assert_allclose(several.gap, [2.0, 2.0], rtol=1e-12)
    np.testing.assert_array_equal(several.body_b, [3, 3])
    left, right = np.sort(several.point_b[:, 0])
    assert 2 <= left <= 4
    assert 7 <= right <= 9


def test_bodies_far_apart_are_not_marched(monkeypatch):
    def refuse(*_):
        raise AssertionError("marched")

    monkeypatch.setitem(WAVES, "exact", refuse)
    bodies, walls = [ball(0.1), ball(0.1)], box_walls(np.zeros(2), np.full(2, 2.0), 2)
    pose = upright([0.6, 0.6], [1.4, 1.4])
    mesh = generate_mesh(FluidDomain(bodies, pose, box(np.zeros(2), np.full(2, 2.0)), ()), Sizes(0.3, 0.05, 0.5))
    assert len(narrow_band(bodies, walls).detect(pose, mesh, 0.4)) == 0


def test_a_band_narrower_than_the_range_is_refused():
    assert narrow_band([], []).preferred_reach(0.02) == pytest.approx(0.03)
    assert narrow_band([], [], band_width=0.1).preferred_reach(0.02) == 0.1
    with pytest.raises(SceneError, match=r"contact.band_width: found 0.01.*at least the range, 0.02"):
        narrow_band([], [], band_width=0.01).preferred_reach(0.02)
