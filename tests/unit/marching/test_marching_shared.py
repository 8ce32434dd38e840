"""Contacts on a mesh in parts are those on the whole, to the last bit."""

from dataclasses import fields, replace

import numpy as np
import pytest
from marching_meshes import stars
from mesh_tools import ball, box, box_walls, random_ellipsoids, upright
from threaded_ranks import ThreadedRanks, on_ranks

from rigidfluid.core.mesh.distribution import distributed
from rigidfluid.core.mesh.fluid_domain import FluidDomain
from rigidfluid.core.mesh.generation.meshing import generate_mesh
from rigidfluid.core.mesh.size.size_field import Sizes
from rigidfluid.core.model.types import Contacts
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector
from rigidfluid.errors import SceneError
from rigidfluid.marching.exact import put_back
from rigidfluid.marching.field import Band, exact_wave
from rigidfluid.marching.shared import SharedMesh
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.workspace import KNOWN, new_workspace

REACH = 0.25


def part_of(mesh, ranks):
    return distributed(mesh if ranks.is_root else None, ranks)


def made(kind, bodies, walls, **options):
    return kind(kind.Options(**options), bodies, walls)


def assert_same(one, other):
    assert one.shift is None
    assert other.shift is None
    for field in [field for field in fields(Contacts) if field.name not in ("shift", "curvatures")]:
        assert np.array_equal(getattr(one, field.name), getattr(other, field.name), equal_nan=True), field.name


def star_bodies(dimension, seed):
    """Stars as bodies of bounding balls that hold everything, so that every pair is measured."""
    mesh, _ = stars(dimension, seed)
    count = int(mesh.markers.max()) + 1 - 2 * dimension
    middle = [mesh.points[np.unique(mesh.facets[mesh.markers == i])].mean(axis=0) for i in range(count)]
    walls = box_walls(np.full(dimension, -3.0), np.full(dimension, 3.0), count)
    return [ball(5.0, dimension)] * count, walls, upright(*middle), mesh


def detected(detector, pose, mesh):
    """Contacts before they are checked: stars may touch, and then there is no normal."""
    with np.errstate(invalid="ignore"):
        return type(detector).detect.__wrapped__(detector, pose, mesh, REACH)


def shifted(mesh):
    return replace(mesh, points=mesh.points + 0.01)


@pytest.mark.parametrize(
    ("scene", "dimension", "seed", "count", "multiple", "kind"),
    [
        (random_ellipsoids, 2, 0, 2, False, NarrowBandDetector),
        (random_ellipsoids, 2, 1, 3, True, NarrowBandDetector),
        (random_ellipsoids, 2, 2, 5, False, FastMarchingDetector),
        pytest.param(random_ellipsoids, 3, 0, 3, False, NarrowBandDetector, marks=pytest.mark.long),
        (star_bodies, 2, 7, 2, True, FastMarchingDetector),
        (star_bodies, 2, 7, 5, True, NarrowBandDetector),
        (star_bodies, 3, 7, 2, False, NarrowBandDetector),
        (star_bodies, 3, 7, 4, True, NarrowBandDetector),
    ],
)
def test_contacts_are_those_of_the_whole_mesh_also_when_it_has_moved(scene, dimension, seed, count, multiple, kind):
    bodies, walls, pose, mesh = scene(dimension, seed)
    moved = replace(pose, position=pose.position + 0.01)
    serial = made(kind, bodies, walls, multiple=multiple)
    expected = detected(serial, pose, mesh), detected(serial, moved, shifted(mesh))
    assert len(expected[0]) > len(bodies) / 2

    def work(ranks):
        part, detector = part_of(mesh, ranks), made(kind, bodies, walls, multiple=multiple)
        return detected(detector, pose, part), detected(detector, moved, shifted(part))

    for found in on_ranks(count, work):
        assert_same(found[0], expected[0])
        assert_same(found[1], expected[1])


@pytest.mark.parametrize(("scene", "dimension"), [(random_ellipsoids, 2), (star_bodies, 3)])
def test_where_parts_meet_the_owner_s_vertices_count(scene, dimension):
    bodies, walls, pose, mesh = scene(dimension, 0)
    expected = detected(made(NarrowBandDetector, bodies, walls), pose, mesh)
    copies = []

    def work(ranks):
        part = part_of(mesh, ranks)
        copy = ~part.part.owned & np.isin(np.arange(len(part.points)), part.facets)
        copies.append(copy.sum())
        off = replace(part, points=part.points + 1e-3 * copy[:, None])
        return detected(made(NarrowBandDetector, bodies, walls), pose, off)

    for found in on_ranks(5, work):
        assert_same(found, expected)
    assert sum(copies) > 0


def test_a_new_mesh_is_not_taken_for_the_one_before():
    bodies, walls, pose, mesh = random_ellipsoids(2, 0)
    before = random_ellipsoids(2, 1)
    expected = made(NarrowBandDetector, bodies, walls).detect(pose, mesh, REACH)

    def work(ranks):
        detector = made(NarrowBandDetector, bodies, walls)
        detector.detect(before[2], part_of(before[3], ranks), REACH)
        return detector.detect(pose, part_of(mesh, ranks), REACH)

    assert_same(on_ranks(2, work)[0], expected)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_band_ends_where_that_of_the_whole_does(dimension, seed):
    """It goes further at a vertex with a long edge, which may be in another part."""
    mesh, _ = stars(dimension, seed)
    whole = new_workspace(len(mesh.points))
    exact_wave(Topology.from_mesh(mesh), mesh.points, [0], Band(0.1, 0.5), whole)

    def work(ranks):
        part = part_of(mesh, ranks)
        shared = SharedMesh(part)
        points, space = shared.points(part), shared.part.workspace
        [march] = shared.march(points, [[0]], Band(0.1, 0.5))
        if march is not None:
            put_back(space, *march[:4])
        inside = slice(len(part.points))
        return part.part.vertices, space.state[inside] == KNOWN, space.key[inside]

    for vertices, known, key in on_ranks(4, work):
        assert np.array_equal(known, whole.state[vertices] == KNOWN)
        np.testing.assert_allclose(key[known], whole.key[vertices][known], rtol=0, atol=1e-15)


def test_ranks_exchange_what_is_new(monkeypatch):
    bodies, walls, pose, mesh = random_ellipsoids(2, 0)
    sent = sent_by(monkeypatch)

    def work(ranks):
        detector = made(NarrowBandDetector, bodies, walls)
        detector.detect(pose, part_of(mesh, ranks), REACH)
        shared = detector._finder._shared
        return len(shared.part.border)

    border, _ = on_ranks(2, work)
    lists = [item for item in sent if isinstance(item, list) and isinstance(item[0], tuple)]
    posts = [item for item in lists if isinstance(item[0][0], bool)]
    assert len(posts) in (4, 6, 8)  # two ranks exchange for all bodies together; the last time they find nothing
    keys = np.concatenate([key for post in posts for _, (_, _, key, _) in post])
    assert 0 < len(keys) <= len(bodies) * border
    assert keys.min() > 0.0  # what is on a body is known to all


def test_a_body_in_another_part_is_not_marched_from():
    bodies, _, _, mesh = random_ellipsoids(2, 0)

    def work(ranks):
        part = part_of(mesh, ranks)
        shared = SharedMesh(part)
        points = shared.points(part)
        marches = shared.march(points, [[body] for body in range(len(bodies))], Band(0.01, 0.5))
        held = [np.isin(body, part.markers) for body in range(len(bodies))]
        return [march is not None for march in marches], held

    for marched, held in on_ranks(4, work):
        assert sum(marched) < len(bodies)
        assert all(np.array(marched)[held])


def test_where_nothing_is_near_nobody_is_asked(monkeypatch):
    bodies, pose = [ball(0.2), ball(0.2)], upright([0.5, 0.5], [1.5, 0.5])
    mesh = generate_mesh(FluidDomain(bodies, pose, box(np.zeros(2), np.array([2.0, 1.0])), ()), Sizes(0.2, 0.1, 0.5))

    def work(ranks):
        part, detector = part_of(mesh, ranks), made(NarrowBandDetector, bodies, [])
        sent = sent_by(monkeypatch)
        return len(detector.detect(pose, part, 0.5)), len(sent)

    assert on_ranks(2, work) == [(0, 0)] * 2


def sent_by(monkeypatch):
    """What the ranks are going to hand each other."""
    sent, exchange = [], ThreadedRanks.exchange

    def recorded(ranks, item):
        sent.append(item)
        return exchange(ranks, item)

    monkeypatch.setattr(ThreadedRanks, "exchange", recorded)
    return sent


def test_the_first_order_march_is_refused_by_all():
    bodies, walls, pose, mesh = random_ellipsoids(2, 0)

    def work(ranks):
        detector = made(NarrowBandDetector, bodies, walls, accuracy="first-order")
        with pytest.raises(SceneError, match=r"contact.accuracy: found 'first-order' with 2 processes; allowed"):
            detector.detect(pose, part_of(mesh, ranks), REACH)

    on_ranks(2, work)
