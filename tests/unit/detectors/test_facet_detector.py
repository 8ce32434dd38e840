"""Contacts of polygons and polyhedra against dense samples of both, and where there are several."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from facet_shapes import BAR, CUBE, L_SHAPE, SQUARE, TRIANGLES, binary_stl, polygon, polyhedron
from mesh_tools import ball, ellipsoid
from unknown_shapes import Cross

from rigidfluid.bodies.sphere import SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.facet_surface import FacetSurface
from rigidfluid.core.geometry.facets import Facets
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.detectors.facets import FacetDetector
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.domains.arc import Arc
from rigidfluid.errors import SceneError

FLOOR = Wall(9, "floor", Plane(np.zeros(2), np.array([0.0, 1.0])))


def pose(*rows: tuple[float, float, float]) -> Pose:
    return Pose(np.array([row[:2] for row in rows]), np.array([row[2:] for row in rows]))


def found(bodies: list[Body], at: Pose, *walls: Wall, reach: float = np.inf) -> Contacts:
    contacts = FacetDetector(PartOptions(), bodies, walls).detect(at, None, reach)
    np.testing.assert_allclose(contacts.point_a, contacts.point_b + contacts.gap[:, None] * contacts.normal, atol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1.0, atol=1e-14)
    return contacts


def sampled_gap(bodies: list[Body], at: Pose) -> float:
    """The least distance of dense samples of a to b."""
    a, b = rotation_matrices(at.orientation)
    samples = at.position[0] + np.concatenate([bodies[0].sample_surface(20_000), bodies[0].facets.points]) @ a.T
    return float(bodies[1].signed_distance((samples - at.position[1]) @ b).min())


def test_least_gaps_are_those_of_dense_samples() -> None:
    rng, apart = np.random.default_rng(0), 0
    for _ in range(60):
        bodies: list[Body] = [polygon([SQUARE, L_SHAPE, BAR][i]) for i in rng.integers(0, 3, 2)]
        at = pose((0.0, 0.0, rng.uniform(0, 7)), (*rng.uniform(-2.2, 2.2, 2), rng.uniform(0, 7)))
        expected, contacts = sampled_gap(bodies, at), found(bodies, at)
        if expected > 1e-3:
            assert contacts.gap.min() == pytest.approx(expected, abs=2e-4)
            apart += 1
        elif expected < -1e-3:
            assert contacts.gap.min() < 0
    assert apart > 20


def test_a_square_on_the_floor_has_a_contact_at_each_lower_corner() -> None:
    contacts = found([polygon(SQUARE)], pose((3.0, 0.51, 0.0)), FLOOR)
    np.testing.assert_allclose(contacts.gap[:2], 0.01, rtol=1e-12)
    np.testing.assert_allclose(np.sort(contacts.point_a[:2, 0]), [2.5, 3.5])
    assert len(contacts) == 2
    assert contacts.at_wall.all()
    assert np.isinf(contacts.radius_b).all()


def test_contacts_of_a_tilting_square_change_without_a_jump() -> None:
    """A corner stays in the list while it faces the floor, however little the square is tilted."""
    tilts = np.linspace(-0.2, 0.2, 41)
    gaps = [np.sort(found([polygon(SQUARE)], pose((0.0, 0.8, tilt)), FLOOR).gap) for tilt in tilts]
    lower = 0.8 - np.hypot(0.5, 0.5) * np.stack([np.sin(np.pi / 4 + np.abs(tilts)), np.sin(np.pi / 4 - np.abs(tilts))])
    np.testing.assert_allclose(np.array(gaps), lower.T, rtol=1e-12)


def test_blocks_that_overhang_each_other_touch_at_a_corner_of_each() -> None:
    contacts = found([polygon(SQUARE), polygon(SQUARE)], pose((0.6, 1.01, 0.0), (0.0, 0.0, 0.0)))
    np.testing.assert_allclose(contacts.gap, 0.01, rtol=1e-12)
    np.testing.assert_allclose(np.sort(contacts.point_a[:, 0]), [0.1, 0.5])
    np.testing.assert_allclose(contacts.normal, [[0.0, 1.0]] * 2, atol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 1e-16, -1e-15, 1e-12, 1e-9])
def test_squares_with_corner_over_corner_touch_as_often_as_those_beside(shift: float) -> None:
    """Twice at each end: rounding may say that a foot is the end of a side, and also an inside of the next one."""
    contacts = found([polygon(SQUARE), polygon(SQUARE)], pose((2.7 + shift, 1.36, 0.0), (2.7, 0.35, 0.0)), reach=0.1)
    np.testing.assert_allclose(contacts.gap, [0.01] * 4, rtol=1e-9)


def test_a_ball_in_the_corner_of_an_l_touches_both_arms() -> None:
    shape = polygon(L_SHAPE)
    corner = shape.facets.points[3]
    for order in (1, -1):
        bodies, at = [ball(0.2, 2), shape], pose((*(corner + [0.22, 0.21]), 0.0), (0.0, 0.0, 0.0))
        contacts = found(bodies[::order], Pose(at.position[::order], at.orientation[::order]))
        np.testing.assert_allclose(contacts.gap, [0.01, 0.02], rtol=1e-12)
        np.testing.assert_allclose(contacts.normal, order * np.array([[0.0, 1.0], [1.0, 0.0]]), atol=1e-14)


def test_overlap_is_negative_with_and_without_a_corner_inside() -> None:
    in_floor = found([polygon(SQUARE)], pose((0.0, 0.4, 0.0)), FLOOR)
    np.testing.assert_allclose(in_floor.gap[:2], -0.1, rtol=1e-12)
    crossed = found([polygon(BAR), polygon(BAR)], pose((0.0, 0.0, 0.0), (0.0, 0.0, np.pi / 2)))
    assert crossed.gap.min() == pytest.approx(-1.1)  # a bar drawn out along itself
    inside = found([polygon(np.array(SQUARE) * 0.1), polygon(SQUARE)], pose((0.0, 0.1, 0.0), (0.0, 0.0, 0.0)))
    assert inside.gap.min() == pytest.approx(-0.45)


def round_wall(surface: int, radius: float, centre: FloatArray) -> Wall:
    size = abs(radius)

    class Round(Plane):
        """A circle, its inside the fluid where the radius is negative."""

        plane, radius = None, property(lambda _: radius)  # type: ignore[assignment]
        bounds = centre - size, centre + size  # type: ignore[assignment]

        def signed_distance(self, points: FloatArray) -> FloatArray:
            return np.asarray(np.sign(radius) * (np.linalg.norm(points - centre, axis=1) - abs(radius)))

        def closest_point(self, points: FloatArray) -> FloatArray:
            away = points - centre
            return np.asarray(centre + abs(radius) * away / np.linalg.norm(away, axis=1, keepdims=True))

        def normal(self, points: FloatArray) -> FloatArray:
            away = points - centre
            return np.asarray(np.sign(radius) * away / np.linalg.norm(away, axis=1, keepdims=True))

    return Wall(surface, "round", Round(np.zeros(2), np.array([0.0, 1.0])))


def test_round_walls_are_met_by_corners_in_a_hollow_and_by_edges_on_a_bump() -> None:
    hollow = found([polygon(SQUARE)], pose((0.0, -1.0, 0.0)), round_wall(9, -2.0, np.zeros(2)))
    np.testing.assert_allclose(hollow.gap[:2], 2.0 - np.hypot(0.5, 1.5), rtol=1e-12)
    np.testing.assert_allclose(hollow.radius_b, -2.0)
    bump = found([polygon(SQUARE)], pose((0.1, 1.52, 0.0)), round_wall(9, 1.0, np.zeros(2)))
    assert bump.gap[0] == pytest.approx(0.02, rel=1e-12)
    np.testing.assert_allclose(bump.point_a[0], [0.0, 1.02], atol=1e-12)


def test_walls_of_facets_have_corners_too() -> None:
    """A room whose floor has a step: a square over the step's edge meets it with its side."""
    room = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [4.0, 1.0], [4.0, 4.0], [0.0, 4.0]])
    numbers = np.arange(6)
    # seen from the fluid inside, edges go round to the right
    whole = FacetSurface(Facets(room, np.stack([np.roll(numbers, -1), numbers], axis=1), np.array([0, 0, 0, 1, 1, 1])))
    step = Wall(9, "floor", whole.piece(0))
    tilted = found([polygon(SQUARE)], pose((1.6, 1.55, np.pi / 4)), step)
    away = np.array([2.0, 1.0]) - [1.6, 1.55]
    assert tilted.gap[0] == pytest.approx(np.abs(away @ np.array([1.0, -1.0])) / np.sqrt(2.0) - 0.5, rel=1e-12)
    for detector in (FacetDetector, SphereDetector):
        balls = detector(PartOptions(), [ball(0.3, 2)] * 2, [step])
        in_corner = balls.detect(pose((1.65, 0.32, 0.0), (0.7, 0.4, 0.0)), None, np.inf)
        at_wall = in_corner.at_wall
        np.testing.assert_allclose(in_corner.gap[at_wall], [0.02, 0.05, 0.1], rtol=1e-11)
        np.testing.assert_array_equal(in_corner.body_a[at_wall], [0, 0, 1])


def test_other_shapes_are_refused_by_name() -> None:
    with pytest.raises(SceneError, match=r'"facets" with body\.0 of type "cross"'):
        FacetDetector(PartOptions(), [Cross(SphereOptions(radius=1.0), 2)], [])


def searched_gap(bodies: list[Body], at: Pose) -> float:
    """The least distance of dense samples of the second body to the first, an ellipsoid."""
    first, second = rotation_matrices(at.orientation)
    samples = np.concatenate([bodies[1].sample_surface(40_000), bodies[1].facets.points])
    return float(bodies[0].signed_distance((at.position[1] + samples @ second.T - at.position[0]) @ first).min())


def test_ellipses_meet_polygons_as_dense_samples_do() -> None:
    rng, apart = np.random.default_rng(5), 0
    for _ in range(60):
        bodies = [ellipsoid(*rng.uniform(0.1, 1.0, 2)), polygon([SQUARE, L_SHAPE, BAR][rng.integers(3)])]
        at = pose((*rng.uniform(-2.5, 2.5, 2), rng.uniform(0, 7)), (0.0, 0.0, rng.uniform(0, 7)))
        expected = searched_gap(bodies, at)
        for order in (1, -1):
            contacts = found(bodies[::order], Pose(at.position[::order], at.orientation[::order]))
            if expected > 1e-3:
                assert contacts.gap[0] == pytest.approx(expected, abs=1e-7)
            elif expected < -1e-3:
                assert contacts.gap[0] < 0
        apart += expected > 1e-3
    assert apart > 20


def test_an_ellipse_lies_in_the_corner_of_an_l_on_both_arms() -> None:
    shape = polygon(L_SHAPE)
    at = pose((*(shape.facets.points[3] + [0.22, 0.13]), 0.0), (0.0, 0.0, 0.0))
    contacts = found([ellipsoid(0.2, 0.1), shape], at)
    np.testing.assert_allclose(contacts.gap, [0.02, 0.03], rtol=1e-12)
    np.testing.assert_allclose(contacts.normal, [[1.0, 0.0], [0.0, 1.0]], atol=1e-14)


def test_ellipsoids_meet_cubes_as_dense_samples_do(cube: Body) -> None:
    rng, apart = np.random.default_rng(6), 0
    for _ in range(40):
        turns = rng.normal(size=(2, 4))
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        bodies = [ellipsoid(*rng.uniform(0.1, 0.8, 3)), cube]
        at = Pose(np.array([1.3 * rng.normal(size=3), np.zeros(3)]), turns)
        expected, contacts = searched_gap(bodies, at), found(bodies, at)
        if expected > 0.01:
            assert contacts.gap[0] == pytest.approx(expected, abs=2e-3)
            assert contacts.gap[0] <= expected + 1e-12
            apart += 1
        elif expected < -0.01:
            assert contacts.gap[0] < 0
    assert apart > 10


@pytest.fixture
def cube(tmp_path: Path) -> Body:
    return polyhedron(binary_stl(tmp_path / "cube.stl", CUBE, TRIANGLES))


def test_cubes_in_space_meet_as_their_samples_do(cube: Body) -> None:
    rng, apart = np.random.default_rng(1), 0
    for _ in range(30):
        turns = rng.normal(size=(2, 4))
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        at = Pose(np.array([[0.0, 0.0, 0.0], rng.normal(size=3)]), turns)
        expected, contacts = sampled_gap([cube, cube], at), found([cube, cube], at)
        if expected > 0.01:
            assert contacts.gap.min() == pytest.approx(expected, abs=0.01)
            assert contacts.gap.min() <= expected + 1e-12
            apart += 1
        elif expected < -0.01:
            assert contacts.gap.min() < 0
    assert apart > 5


def test_a_cube_lies_on_four_corners_and_on_a_turned_cube_on_eight_crossing_edges(cube: Body) -> None:
    floor = Wall(9, "floor", Plane(np.zeros(3), np.array([0.0, 0.0, 1.0])))
    upright = np.array([[1.0, 0.0, 0.0, 0.0]])
    lying = found([cube], Pose(np.array([[0.0, 0.0, 0.52]]), upright), floor)
    np.testing.assert_allclose(lying.gap, 0.02, rtol=1e-12)
    assert len(lying) == 4
    turned = np.array([np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)])
    stacked = found([cube, cube], Pose(np.array([[0.0, 0.0, 1.01], [0.0, 0.0, 0.0]]), np.stack([turned, upright[0]])))
    np.testing.assert_allclose(stacked.gap[:8], 0.01, rtol=1e-11)
    np.testing.assert_allclose(np.max(np.abs(stacked.point_a[:8, :2]), axis=1), 0.5, rtol=1e-12)
    assert stacked.gap[8:].min() > 0.2  # corners beside the other cube


def test_a_corner_that_is_the_nearest_to_a_bump_counts_as_a_corner_and_as_the_nearest_place() -> None:
    bump = Wall(9, "bump", Arc(np.array([0.0, -0.2]), 0.6, Plane(np.zeros(2), np.array([0.0, 1.0]))))
    corner = found([polygon(SQUARE)], pose((0.0, 0.5 + np.sqrt(0.5), np.pi / 4)), bump)
    np.testing.assert_allclose(corner.gap[:2], 0.1, rtol=1e-12)
    beside = found([polygon(SQUARE)], pose((0.1, 1.0, 0.0)), bump)
    np.testing.assert_allclose(beside.gap[0], 0.1, rtol=1e-12)
    assert beside.gap[1] > 0.15
