import numpy as np
import pytest
from benchmark_scripts import benchmark
from marching_meshes import INNER, OUTER, box, naive_distances, reachable, shell, stars

from rigidfluid.marching.field import Band, distance_field, exact_wave
from rigidfluid.marching.first_order import from_edge, from_triangle
from rigidfluid.marching.topology import Topology
from rigidfluid.marching.walk import local_search_to_vertex
from rigidfluid.marching.workspace import new_workspace

SIZE = {2: 0.06, 3: 0.2}
SURFACES = [[INNER], [OUTER], [INNER, OUTER]]


def field_everywhere(mesh, surfaces, **options):
    return distance_field(Topology.from_mesh(mesh), mesh.points, surfaces, **options).everywhere(len(mesh.points))


def star_shaped(mesh):
    """A body with dents and horns: the shell's inside pushed in and out along the radius."""
    radius = np.linalg.norm(mesh.points, axis=1, keepdims=True)
    x, y = mesh.points[:, :1], mesh.points[:, 1:2]
    bump = 1 + 0.3 * np.cos(5 * np.arctan2(y, x)) * np.hypot(x, y) / radius
    return mesh.points * bump ** (1.2 - radius)


def distortions(mesh):
    stretch = np.array([1.0, 0.15, 0.5])[: mesh.points.shape[1]]
    return {"round": mesh.points, "thin": mesh.points * stretch, "star": star_shaped(mesh)}


@pytest.mark.parametrize("surfaces", SURFACES)
@pytest.mark.parametrize("shape", ["round", "thin", "star"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_exact_march_equals_the_nearest_of_all_facets(dimension, shape, surfaces):
    mesh = shell(dimension, 0.3, 1.2, SIZE[dimension])
    points = distortions(mesh)[shape]
    found = distance_field(Topology.from_mesh(mesh), points, surfaces).everywhere(len(points))
    expected = naive_distances(points, points, mesh.facets[np.isin(mesh.markers, surfaces)])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


@pytest.fixture(scope="module")
def nearest_facet_distances():
    with benchmark("nearest_facet") as module:
        return module.nearest_facet_distances


@pytest.mark.parametrize(("dimension", "seeds"), [(2, 60), (3, 15)])
def test_exact_march_among_ragged_stars_equals_the_nearest_of_all_facets(dimension, seeds, nearest_facet_distances):
    for number in range(seeds):
        mesh, surfaces = stars(dimension, number)
        topology = Topology.from_mesh(mesh)
        expected = nearest_facet_distances(mesh.points, mesh.points[mesh.facets[np.isin(mesh.markers, surfaces)]])
        for width in (np.inf, np.quantile(expected, 0.4) * (1 + 1e-9)):
            field = distance_field(topology, mesh.points, surfaces, width)
            np.testing.assert_allclose(field.distance, expected[field.vertices], rtol=1e-12, atol=0, err_msg=number)
            np.testing.assert_array_equal(np.sort(field.vertices), reachable(mesh, surfaces, expected <= width))


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_tree_is_planted_unless_the_surface_is_convex_from_the_fluid(dimension):
    mesh = shell(dimension, 0.3, 1.2, SIZE[dimension])
    for points, surfaces, convex in [
        (mesh.points, [INNER], True),
        (mesh.points, [OUTER], False),
        (mesh.points, [INNER, OUTER], False),
        (star_shaped(mesh), [INNER], False),
    ]:
        work = new_workspace(len(points))
        wave = exact_wave(Topology.from_mesh(mesh), points, surfaces, Band(np.inf), work)
        assert (len(wave.target.tree.order) == 0) == convex


@pytest.mark.parametrize("dimension", [2, 3])
def test_exact_march_is_second_order_to_the_true_circle(dimension):
    errors = []
    for size in (SIZE[dimension], SIZE[dimension] / 2):
        mesh = shell(dimension, 0.3, 1.2, size)
        true = np.linalg.norm(mesh.points, axis=1) - 0.3
        errors.append(np.abs(field_everywhere(mesh, [INNER]) - true).max())
    assert np.log2(errors[0] / errors[1]) > 1.7


@pytest.mark.parametrize("dimension", [2, 3])
def test_first_order_march_is_first_order(dimension):
    errors = []
    for size in (SIZE[dimension], SIZE[dimension] / 2):
        mesh = shell(dimension, 0.3, 1.2, size)
        true = np.linalg.norm(mesh.points, axis=1) - 0.3
        errors.append(np.abs(field_everywhere(mesh, [INNER], accuracy="first-order") - true).mean())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.35)
    assert errors[1] < 0.15 * SIZE[dimension]


@pytest.mark.parametrize("accuracy", ["exact", "first-order"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_plane_wave_from_a_wall_is_exact_where_no_cell_is_obtuse(dimension, accuracy):
    mesh = box(dimension, 8)
    found = field_everywhere(mesh, [0], accuracy=accuracy)
    np.testing.assert_allclose(found, mesh.points[:, 0], rtol=0, atol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_first_order_on_bad_cells_stays_an_upper_bound_near_the_truth(dimension):
    mesh = box(dimension, 8, seed=1)
    squeezed = mesh.points * np.array([1.0, 0.2, 1.0])[:dimension]
    found = distance_field(Topology.from_mesh(mesh), squeezed, [0], accuracy="first-order").everywhere(len(squeezed))
    assert np.all(found >= squeezed[:, 0] - 1e-12)
    assert np.abs(found - squeezed[:, 0]).max() < 0.1


@pytest.mark.parametrize("accuracy", ["exact", "first-order"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_band_is_the_full_field_cut_off(dimension, accuracy):
    mesh = shell(dimension, 0.3, 1.2, SIZE[dimension])
    topology = Topology.from_mesh(mesh)
    full = distance_field(topology, mesh.points, [INNER], accuracy=accuracy).everywhere(len(mesh.points))
    band = distance_field(topology, mesh.points, [INNER], band_width=0.35, accuracy=accuracy)
    assert set(band.vertices) == set(np.flatnonzero(full <= 0.35))
    np.testing.assert_array_equal(band.distance, full[band.vertices])
    everywhere = band.everywhere(len(mesh.points))
    assert np.all(everywhere[full > 0.35] == band.distance.max())


@pytest.mark.parametrize("accuracy", ["exact", "first-order"])
def test_a_workspace_serves_again_as_if_new(accuracy):
    mesh = shell(2, 0.3, 1.2, 0.06)
    topology = Topology.from_mesh(mesh)
    work = new_workspace(len(mesh.points))
    distance_field(topology, mesh.points, [OUTER], accuracy=accuracy, workspace=work)
    again = distance_field(topology, mesh.points, [INNER], 0.2, accuracy, work)
    fresh = distance_field(topology, mesh.points, [INNER], 0.2, accuracy)
    np.testing.assert_array_equal(again.vertices, fresh.vertices)
    np.testing.assert_array_equal(again.distance, fresh.distance)
    assert not work.state.any()


def test_a_surface_that_is_not_there_reaches_nothing():
    mesh = box(2, 4)
    field = distance_field(Topology.from_mesh(mesh), mesh.points, [17])
    assert len(field.vertices) == 0
    assert field.largest == 0.0


@pytest.mark.parametrize("dimension", [2, 3])
def test_nearest_facets_are_those_of_the_distance(dimension):
    mesh = shell(dimension, 0.3, 1.2, SIZE[dimension])
    field = distance_field(Topology.from_mesh(mesh), mesh.points, [INNER])
    for vertex, distance, facet in list(zip(field.vertices, field.distance, field.facet, strict=True))[::37]:
        naive = naive_distances(mesh.points[vertex][None], mesh.points, mesh.facets[facet][None])
        assert naive[0] == pytest.approx(distance, abs=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_walk_over_a_convex_surface_ends_on_the_nearest_facet(dimension):
    mesh = shell(dimension, 0.3, 1.2, SIZE[dimension])
    topology = Topology.from_mesh(mesh)
    seeds, wanted, _ = topology.seeds([INNER])
    middle = mesh.points[mesh.facets].mean(axis=1)
    for vertex in range(len(mesh.points))[-1:0:-101]:
        point = mesh.points[vertex]
        facing = [facet for facet in seeds if middle[facet] @ point > 0.2 * np.linalg.norm(point) * 0.3]
        ends = [local_search_to_vertex(mesh.points, vertex, topology.surfaces, wanted, facet)[0] for facet in facing]
        nearest = naive_distances(point[None], mesh.points, mesh.facets[seeds])[0]
        np.testing.assert_allclose(np.sqrt(ends), nearest, rtol=1e-12)


@pytest.mark.parametrize("update", [from_edge, from_triangle])
def test_a_plane_wave_is_met_exactly_if_it_comes_from_between_the_corners(update):
    rng = np.random.default_rng(0)
    corners = 2 if update is from_edge else 3
    met = 0
    for _ in range(1000):
        points = np.concatenate([np.zeros((1, corners)), rng.normal(size=(corners, corners))])
        wave = rng.normal(size=corners)
        wave /= np.linalg.norm(wave)
        weights = np.linalg.solve(points[1:].T, -wave)
        found = update(points, 0, *range(1, corners + 1), points @ wave)
        if np.all(weights > 1e-6) and np.all(points[1:] @ wave < 0.0):
            met += 1
            assert found == pytest.approx(0.0, abs=1e-9)
        elif np.any(weights < -1e-6):
            assert found == np.inf or abs(found) > 1e-9
    assert met > 20
