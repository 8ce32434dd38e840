"""Distances to surfaces of facets against all facets one by one and the winding of the surface."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets, area_vectors
from rigidfluid.core.geometry.surface import Plane

L_SHAPE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]])
# corners of a cube, and its facets seen from outside
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SQUARES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def polygon(corners: FloatArray) -> Facets:
    numbers = np.arange(len(corners))
    return Facets(corners, np.stack([numbers, np.roll(numbers, -1)], axis=1), numbers)


def notched_cube() -> Facets:
    """A cube with its top pushed in to a pyramid, which is not convex and has edges and corners of all kinds."""
    points = np.vstack([CUBE, [0.5, 0.5, 0.3]])
    triangles = [[a, b, c] for a, b, c, _ in SQUARES[:5]] + [[a, c, d] for a, _, c, d in SQUARES[:5]]
    top = SQUARES[5]
    triangles += [[a, b, 8] for a, b in pairwise([*top, top[0]])]
    return Facets(points, np.array(triangles), np.repeat(np.arange(len(triangles)), 1))


def shapes() -> list[Facets]:
    return [polygon(L_SHAPE), notched_cube()]


def queries(dimension: int) -> FloatArray:
    scattered = np.random.default_rng(4).uniform(-1.0, 2.5, (2000, dimension))
    on_axes = np.stack(np.meshgrid(*[np.linspace(-0.5, 1.5, 9)] * dimension), axis=-1).reshape(-1, dimension)
    return np.concatenate([scattered, on_axes + 1e-3 * np.array([1.0, 2.0, 3.0])[:dimension]])


def naive_distance(facets: Facets, points: FloatArray) -> FloatArray:
    """By dense samples of each facet, an upper bound that is 2 samples' distance off at most."""
    steps = np.linspace(0.0, 1.0, 201)
    if points.shape[1] == 2:
        weights = np.stack([1 - steps, steps], axis=1)
    else:
        s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
        inside = s + t <= 1 + 1e-12
        weights = np.stack([1 - s - t, s, t], axis=1)[inside]
    samples = np.einsum("wi,fij->fwj", weights, facets.points[facets.vertices]).reshape(-1, points.shape[1])
    from scipy.spatial import KDTree

    return np.asarray(KDTree(samples).query(points)[0])


def winding(facets: Facets, points: FloatArray) -> IntArray:
    """How often the surface goes round each point: the angle it is seen at, over the full one."""
    rays = facets.points[facets.vertices][None] - points[:, None, None]
    if points.shape[1] == 2:
        a, b = rays[:, :, 0], rays[:, :, 1]
        angle = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], np.sum(a * b, axis=-1))
        return np.rint(angle.sum(axis=1) / (2 * np.pi)).astype(int)
    a, b, c = np.moveaxis(rays, 2, 0)
    la, lb, lc = (np.linalg.norm(ray, axis=-1) for ray in (a, b, c))
    below = la * lb * lc + np.sum(a * b, -1) * lc + np.sum(b * c, -1) * la + np.sum(c * a, -1) * lb
    angle = 2 * np.arctan2(np.linalg.det(rays), below)
    return np.rint(angle.sum(axis=1) / (4 * np.pi)).astype(int)


@pytest.mark.parametrize("facets", shapes(), ids=["plane", "space"])
def test_distance_is_that_of_all_facets_and_the_sign_that_of_the_winding(facets: Facets) -> None:
    points = queries(facets.points.shape[1])
    found = FacetSurface(facets).signed_distance(points)
    np.testing.assert_allclose(np.abs(found), naive_distance(facets, points), rtol=0, atol=0.01)
    np.testing.assert_array_equal(found < 0, winding(facets, points) != 0)


@pytest.mark.parametrize("facets", shapes(), ids=["plane", "space"])
def test_closest_points_are_on_the_surface_and_as_far_as_told(facets: Facets) -> None:
    surface, points = FacetSurface(facets), queries(facets.points.shape[1])
    foot = surface.closest_point(points)
    away = np.linalg.norm(points - foot, axis=1)
    np.testing.assert_allclose(away, np.abs(surface.signed_distance(points)), rtol=0, atol=1e-15)
    np.testing.assert_allclose(surface.signed_distance(foot), 0.0, atol=1e-15)
    np.testing.assert_allclose(surface.closest_point(foot), foot, rtol=0, atol=1e-15)


@pytest.mark.parametrize("facets", shapes(), ids=["plane", "space"])
def test_normals_are_the_slope_of_the_distance(facets: Facets) -> None:
    surface, points = FacetSurface(facets), queries(facets.points.shape[1])
    steps = 1e-6 * np.eye(points.shape[1])
    slope = np.stack(
        [(surface.signed_distance(points + step) - surface.signed_distance(points - step)) / 2e-6 for step in steps],
        axis=1,
    )
    smooth = np.abs(np.linalg.norm(slope, axis=1) - 1) < 1e-6
    assert np.mean(smooth) > 0.95
    np.testing.assert_allclose(surface.normal(points)[smooth], slope[smooth], rtol=0, atol=1e-6)


def test_normals_at_a_corner_itself_are_the_mean_of_those_around_it() -> None:
    found = FacetSurface(polygon(L_SHAPE)).normal(L_SHAPE)
    np.testing.assert_allclose(found[0], [-np.sqrt(0.5), -np.sqrt(0.5)], atol=1e-15)
    found = FacetSurface(notched_cube()).normal(CUBE[:1])
    np.testing.assert_allclose(found[0], -np.ones(3) / np.sqrt(3.0), atol=1e-15)


def test_flat_pieces_are_their_plane_unless_it_goes_on_inside() -> None:
    """The fluid is inside an L: planes of the two sides at the corner that points inwards go on there."""
    room = FacetSurface(polygon(L_SHAPE[::-1]))
    assert room.plane is None
    assert room.radius is None
    pieces = [room.piece(number) for number in range(6)]
    assert [isinstance(piece, Plane) for piece in pieces].count(False) == 2
    (floor,) = (piece for piece in pieces if piece.bounds[1][1] == 0.0)
    assert floor.plane is not None
    assert floor.plane.axis == 1
    np.testing.assert_array_equal(floor.plane.unit_normal, [0.0, 1.0])
    np.testing.assert_array_equal(floor.bounds, [[0.0, 0.0], [2.0, 0.0]])
    points = np.random.default_rng(0).uniform(0.0, 2.0, (50, 2))
    for piece in pieces:  # a surface that says it is a plane measures to all of it
        if piece.plane is not None:
            assert piece.radius == np.inf
            np.testing.assert_array_equal(piece.signed_distance(points), piece.plane.signed_distance(points))


def test_a_piece_takes_the_sign_of_the_whole_in_the_fluid() -> None:
    # fluid inside an L: round the inner corner, behind the plane of the piece, there is still fluid
    room = FacetSurface(polygon(L_SHAPE[::-1]))
    names = [tuple(edge) for edge in room.facets.points[room.facets.vertices].sum(axis=1).tolist()]
    ledge = room.piece(names.index((2.5, 1.0)))  # from (0.5, 0.5) to (2, 0.5), the fluid below
    around = np.array([[0.25, 0.9], [1.0, 0.4], [1.0, 0.6]])
    foot = np.array([[0.5, 0.5], [1.0, 0.5], [1.0, 0.5]])
    expected = np.linalg.norm(around - foot, axis=1) * [1.0, 1.0, -1.0]
    np.testing.assert_allclose(ledge.signed_distance(around), expected, rtol=1e-15)
    assert isinstance(ledge, FacetSurface)
    alone = FacetSurface(ledge.facets)
    assert alone.signed_distance(around)[0] < 0


def test_area_vectors_point_into_the_fluid_and_add_up_to_nothing() -> None:
    for facets in shapes():
        vectors = area_vectors(facets.points, facets.vertices)
        np.testing.assert_allclose(vectors.sum(axis=0), 0.0, atol=1e-15)
        flux = np.einsum("fj,fj->", vectors, facets.points[facets.vertices].mean(axis=1))
        volume = {2: 1.25, 3: 1.0 - 0.7 / 3}[facets.points.shape[1]]
        assert flux / facets.points.shape[1] == pytest.approx(volume, rel=1e-14)


def test_places_are_the_sides_of_a_hollow_and_those_of_the_whole_shape_outside() -> None:
    inner = FacetSurface(polygon(L_SHAPE))
    found = inner.nearby(np.array([[0.8, 0.7], [3.0, 0.7], [0.25, 0.25]]), np.inf, np.inf)
    order = np.lexsort((found.distance, found.point))
    np.testing.assert_array_equal(found.point[order], [0, 0, 1, 1, 2])
    np.testing.assert_allclose(found.distance[order], [0.2, 0.3, np.hypot(1.0, 0.2), 2.5, -0.25], rtol=1e-14)
    np.testing.assert_allclose(found.foot[order][:3], [[0.8, 0.5], [0.5, 0.7], [2.0, 0.5]], atol=1e-15)
    np.testing.assert_allclose(found.normal[order][:2], [[0.0, 1.0], [1.0, 0.0]], atol=1e-15)
    assert len(inner.nearby(np.array([[0.8, 0.7]]), 0.25, np.inf).point) == 1
    assert len(inner.nearby(np.array([[0.8, 0.7]]), np.inf, 0.05).point) == 1
    assert len(inner.nearby(np.array([[0.8, 0.7]]), 0.1, np.inf).point) == 0


def test_a_point_in_the_notch_of_a_cube_is_near_its_four_sides_and_not_its_edges() -> None:
    surface = FacetSurface(notched_cube())
    found = surface.nearby(np.array([[0.5, 0.5, 0.8]]), np.inf, np.inf)
    slope = 0.5 / np.hypot(0.5, 0.7)
    np.testing.assert_allclose(found.distance, 0.5 * slope, rtol=1e-14)
    assert len(found.distance) == 4
    above = surface.nearby(np.array([[0.5, 0.5, 3.0]]), np.inf, np.inf)
    np.testing.assert_allclose(above.distance, np.hypot(2.0, 0.5), rtol=1e-14)  # the middles of the rim's edges


def test_a_piece_asks_the_whole_surface_only_about_points_behind_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """All facets are as far from the middle of a round hollow, so that each query there looks at all of them."""
    angles = np.linspace(0.0, 2.0 * np.pi, 50, endpoint=False)
    whole = FacetSurface(polygon(np.stack([np.cos(angles), -np.sin(angles)], axis=1)))
    piece, asked = FacetSurface(whole.facets, whole), []
    monkeypatch.setattr(whole, "signed_distance", lambda points: asked.extend(points) or -np.ones(len(points)))
    assert len(piece.nearby(np.zeros((1, 2)), 2.0, 0.5).distance) == 50
    assert not asked
    assert piece.signed_distance(np.array([[2.0, 0.0], [0.2, 0.3]]))[0] < 0.0
    np.testing.assert_array_equal(asked, [[2.0, 0.0]])


def cube() -> Facets:
    triangles = [[a, b, c] for a, b, c, _ in SQUARES] + [[a, c, d] for a, _, c, d in SQUARES]
    return Facets(CUBE, np.array(triangles), np.arange(len(triangles)))


@pytest.mark.parametrize("facets", [polygon(L_SHAPE[[0, 1, 2, 5]]), cube(), *shapes()])
def test_places_of_a_convex_shape_are_found_without_a_search(facets: Facets, monkeypatch: pytest.MonkeyPatch) -> None:
    points, surface = queries(facets.points.shape[1]), FacetSurface(facets)
    found = surface.nearby(points, np.inf, np.inf)
    monkeypatch.setattr(FacetSurface, "_is_convex", False)
    searched = FacetSurface(facets).nearby(points, np.inf, np.inf)
    for one, other in zip(found, searched, strict=True):
        np.testing.assert_array_equal(one, other)
    assert len(found.point) > len(points) or surface._is_convex


def test_a_hollow_of_any_depth_is_searched() -> None:
    """Points before a facet by more than rounding have places of their own."""
    for depth in (1e-9, 0.1):
        dented = np.array([[0.0, 0.0], [1.0, depth], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
        assert not FacetSurface(polygon(dented))._is_convex
