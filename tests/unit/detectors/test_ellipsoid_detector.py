"""The closed-form detector of ellipsoids against samples of both surfaces, the naive detector and moved bodies."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from mesh_tools import ball, ellipsoid
from scipy.optimize import minimize
from unknown_shapes import Cross

from rigidfluid.bodies.sphere import SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.unit_sphere import unit_sphere_points
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import moment, rotate, rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.core.setup.geometry_checks import surfaces_of
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.ellipsoid_separation import touching_normal
from rigidfluid.domains.stenosis import Stenosis, StenosisOptions
from rigidfluid.errors import SceneError, StepError

SHAPES = {
    2: [(1.0, 0.5), (1.0, 0.05), (0.3, 0.3)],
    3: [(1.0, 0.5, 0.7), (1.0, 0.05, 0.05), (1.0, 1.0, 0.05), (0.4,) * 3],
}
DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


def detect(bodies: list[Body], pose: Pose, walls: tuple[Wall, ...] = (), reach: float = np.inf) -> Contacts:
    return EllipsoidDetector(PartOptions(), bodies, walls).detect(pose, None, reach)


def turned(random: np.random.Generator, dimension: int, count: int = 2) -> FloatArray:
    quaternions = random.normal(size=(count, 1 if dimension == 2 else 4))
    return quaternions if dimension == 2 else quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)


def random_pairs(dimension: int, apart: tuple[float, float], seed: int = 0) -> list[tuple[list[Body], Pose]]:
    """Two bodies of every two shapes, turned at random, their centres a random distance within ``apart`` away."""
    random, pairs = np.random.default_rng(seed), []
    for one, other in product(SHAPES[dimension], repeat=2):
        line = random.normal(size=dimension)
        place = random.uniform(*apart) * line / np.linalg.norm(line)
        pose = Pose(np.array([place, np.zeros(dimension)]) + 0.1, turned(random, dimension))
        pairs.append(([ellipsoid(*one), ellipsoid(*other)], pose))
    return pairs


def matrices(bodies: list[Body], pose: Pose) -> FloatArray:
    """S = R diag(a), which maps the unit sphere to the surface."""
    return rotation_matrices(pose.orientation) * np.array([body.semi_axes for body in bodies])[:, None, :]


def sampled_distance(bodies: list[Body], pose: Pose) -> float:
    """Distance of two separate surfaces: the nearest of many points of each, then a search over both."""
    halves, samples = matrices(bodies, pose), unit_sphere_points(400, pose.position.shape[1])
    points = [place + samples @ half.T for place, half in zip(pose.position, halves, strict=True)]
    apart = np.linalg.norm(points[0][:, None] - points[1][None], axis=2)
    first, second = np.unravel_index(np.argmin(apart), apart.shape)
    start = np.concatenate([samples[first], samples[second]])

    def line(both: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        raw = both.reshape(2, -1)
        length = np.linalg.norm(raw, axis=1, keepdims=True)
        unit = raw / length
        ends = pose.position + np.einsum("bij,bj->bi", halves, unit)
        return ends[0] - ends[1], unit, length

    def square(both: FloatArray) -> tuple[float, FloatArray]:
        apart, unit, length = line(both)
        pulled = 2 * np.array([[1.0], [-1.0]]) * np.einsum("bij,i->bj", halves, apart)
        slope = (pulled - np.sum(pulled * unit, axis=1, keepdims=True) * unit) / length
        return float(apart @ apart), slope.ravel()

    for _ in range(3):  # restarts forget a poor guess of the second derivatives
        start = minimize(square, start, jac=True, method="BFGS", options={"gtol": 1e-13, "maxiter": 5000}).x
    return float(np.sqrt(square(start)[0]))


def sampled_depth(bodies: list[Body], pose: Pose) -> float:
    """The shortest way apart of two bodies that overlap: the best of many directions, then a search over them."""
    halves, offset = matrices(bodies, pose), pose.position[0] - pose.position[1]

    def way(raw: FloatArray) -> float:
        n = raw / np.linalg.norm(raw)
        return float(np.sum(np.linalg.norm(np.einsum("bij,i->bj", halves, n), axis=1)) - n @ offset)

    directions = unit_sphere_points(2000, pose.position.shape[1])
    normals = [directions, *(directions @ np.linalg.inv(half) for half in halves)]
    starts = [row / np.linalg.norm(row) for part in normals for row in part]
    best = sorted(starts, key=way)[:20]
    options = {"xatol": 1e-12, "fatol": 1e-15, "maxiter": 4000, "maxfev": 4000}
    return min(minimize(way, start, method="Nelder-Mead", options=options).fun for start in best)


def check(contacts: Contacts, bodies: list[Body], pose: Pose, tolerance: float) -> None:
    """The points are on both surfaces, face each other along the normal, and the normal is that of both there."""
    along = contacts.gap[:, None] * contacts.normal
    np.testing.assert_allclose(contacts.point_a - contacts.point_b, along, rtol=0, atol=tolerance)
    np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1.0, rtol=1e-14)
    halves = matrices(bodies, pose)
    for body, point, sign in ((0, contacts.point_a[0], -1.0), (1, contacts.point_b[0], 1.0)):
        on_ball = np.linalg.solve(halves[body], point - pose.position[body])
        assert np.linalg.norm(on_ball) == pytest.approx(1.0, abs=1e-12)
        outward = np.linalg.solve(halves[body].T, on_ball)
        np.testing.assert_allclose(sign * outward / np.linalg.norm(outward), contacts.normal[0], rtol=0, atol=1e-10)


@DIMENSIONS
@pytest.mark.parametrize("seed", [0, 1])
def test_separate_pairs_against_samples_of_both_surfaces(dimension: int, seed: int) -> None:
    for bodies, pose in random_pairs(dimension, (2.1, 3.0), seed):
        contacts = detect(bodies, pose)
        assert contacts.gap[0] == pytest.approx(sampled_distance(bodies, pose), abs=1e-8)
        check(contacts, bodies, pose, 1e-14)


@pytest.mark.parametrize("apart", [(0.4, 2.4), (0.05, 0.5)])
def test_where_both_touch_when_scaled_the_plane_gap_has_the_sign_of_the_gap(apart: tuple[float, float]) -> None:
    for seed in range(10):
        for bodies, pose in random_pairs(3, apart, seed):
            (one, other), offset = matrices(bodies, pose), pose.position[0] - pose.position[1]
            n = np.array(touching_normal(tuple(offset), one, other))
            reached = np.linalg.norm(n @ one) + np.linalg.norm(n @ other)
            scale = n @ offset / reached
            on_a, on_b = (half @ half.T @ n / np.linalg.norm(half.T @ n) for half in (one, other))
            np.testing.assert_allclose(scale * (on_a + on_b), offset, rtol=0, atol=1e-9)
            assert (scale > 1.0) == (detect(bodies, pose).gap[0] > 0.0)


@DIMENSIONS
def test_separate_pairs_whose_bounding_balls_overlap(dimension: int) -> None:
    found = 0
    for seed in range(6):
        for bodies, pose in random_pairs(dimension, (0.4, 1.4), seed):
            contacts = detect(bodies, pose)
            check(contacts, bodies, pose, 1e-14)
            if contacts.gap[0] > 1e-3:
                assert contacts.gap[0] == pytest.approx(sampled_distance(bodies, pose), abs=1e-8)
                found += 1
    assert found > 15


@pytest.mark.long
@DIMENSIONS
@pytest.mark.parametrize("apart", [(0.1, 0.6), (0.0, 0.02), (0.0, 0.0)])
def test_overlapping_pairs_against_the_shortest_of_many_ways_apart(dimension: int, apart: tuple[float, float]) -> None:
    found = 0
    for bodies, pose in random_pairs(dimension, apart, seed=3):
        contacts = detect(bodies, pose)
        check(contacts, bodies, pose, 1e-14)
        if contacts.gap[0] < 0.0:
            assert contacts.gap[0] == pytest.approx(-sampled_depth(bodies, pose), abs=1e-8)
            found += 1
    assert found >= 4


def placed_at(gap: float, bodies: list[Body], orientation: FloatArray, normal: FloatArray) -> Pose:
    """The first body's farthest point against the normal lies ``gap`` along it off the second's farthest point."""
    at_rest = Pose(np.zeros((2, len(normal))), orientation)
    on_ball = np.einsum("bij,i->bj", matrices(bodies, at_rest), normal)
    feet = np.einsum("bij,bj->bi", matrices(bodies, at_rest), on_ball / np.linalg.norm(on_ball, axis=1, keepdims=True))
    return Pose(np.array([feet.sum(axis=0) + gap * normal, np.zeros(len(normal))]), orientation)


@DIMENSIONS
@pytest.mark.parametrize("gap", [1e3, 1e-6, 0.0, -1e-6, -2e-3])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_a_known_gap_is_found_at_any_size(dimension: int, gap: float, size: float) -> None:
    random = np.random.default_rng(7)
    for one, other in product(SHAPES[dimension], repeat=2):
        bodies = [ellipsoid(*(size * np.array(axes))) for axes in (one, other)]
        normal = random.normal(size=dimension)
        normal /= np.linalg.norm(normal)
        pose = placed_at(size * gap, bodies, turned(random, dimension), normal)
        contacts = detect(bodies, pose)
        assert contacts.gap[0] / size == pytest.approx(gap, abs=1e-12 * max(gap, 1.0), rel=0)
        np.testing.assert_allclose(contacts.normal, normal[None], rtol=0, atol=1e-11)


@pytest.mark.parametrize("slender", [20.0, 1000.0])
@pytest.mark.parametrize("height", [5.0, 2.000001, 2.0, 1.5])
def test_crossing_needles(slender: float, height: float) -> None:
    long, thin = 1.0, 1.0 / slender
    needles: list[Body] = [ellipsoid(long, thin, thin), ellipsoid(thin, long, thin)]
    shift = np.array([0.3, -0.2, height * thin])  # they cross off their middles
    crossed = Pose(np.array([shift, [0.0, 0.0, 0.0]]), np.tile([1.0, 0.0, 0.0, 0.0], (2, 1)))
    contacts = detect(needles, crossed)
    along = contacts.normal[0]
    reached = [np.linalg.norm(along * body.semi_axes) for body in needles]
    assert contacts.gap[0] == pytest.approx(along @ shift - sum(reached), abs=1e-14)
    check(contacts, needles, crossed, 1e-12)
    middles = Pose(np.array([[0.0, 0.0, height * thin], [0.0, 0.0, 0.0]]), crossed.orientation)
    assert detect(needles, middles).gap[0] == pytest.approx((height - 2) * thin, abs=1e-15)


@DIMENSIONS
def test_the_same_place_and_turn(dimension: int) -> None:
    for axes in SHAPES[dimension]:
        orientation = np.repeat(turned(np.random.default_rng(2), dimension, 1), 2, axis=0)
        pose = Pose(np.ones((2, dimension)), orientation)
        contacts = detect([ellipsoid(*axes), ellipsoid(*axes)], pose)
        assert contacts.gap[0] == pytest.approx(-2 * min(axes), abs=1e-14)
        check(contacts, [ellipsoid(*axes)] * 2, pose, 1e-14)


@DIMENSIONS
def test_side_by_side_and_end_to_end(dimension: int) -> None:
    """All slopes vanish by symmetry at the line of centres, where the gap may be least as well as largest."""
    axes, upright = [1.0, 0.2, 0.2][:dimension], [[0.0], [0.0]] if dimension == 2 else [[1.0, 0.0, 0.0, 0.0]] * 2
    for along, apart, gap in ((0, 2.1, 0.1), (1, 0.5, 0.1), (0, 1.99, -0.01), (1, 0.3, -0.1)):
        pose = Pose(apart * np.eye(2, dimension)[[along, along]] * [[1.0], [0.0]], np.array(upright))
        contacts = detect([ellipsoid(*axes), ellipsoid(*axes)], pose)
        assert contacts.gap[0] == pytest.approx(gap, abs=1e-15)
    near = Pose(0.5 * np.eye(2, dimension)[[0, 0]] * [[1.0], [0.0]], np.array(upright))
    bodies: list[Body] = [ellipsoid(*axes), ellipsoid(*axes)]
    contacts = detect(bodies, near)
    assert contacts.gap[0] == pytest.approx(-sampled_depth(bodies, near), abs=1e-10)
    assert abs(contacts.normal[0, 1:]).max() > 0.5  # sideways is shorter than back


@DIMENSIONS
@pytest.mark.parametrize("axes", [(1.0, 0.05, 0.05), (1.0, 0.05, 1.0), (1.0, 0.9, 0.8), (1.0, 0.4, 0.05)])
def test_a_ball_is_as_far_as_the_closest_point_of_its_centre(dimension: int, axes: tuple[float, ...]) -> None:
    random, shape = np.random.default_rng(5), ellipsoid(*axes[:dimension])
    centres = random.uniform(-1.2, 1.2, (200, dimension)) * np.where(
        random.random((200, 1)) < 0.5, 1.0, shape.semi_axes
    )
    bodies = [shape, *[ball(0.02, dimension)] * 200]
    pose = Pose(np.concatenate([np.zeros((1, dimension)), centres]), np.zeros((201, 1)))
    if dimension == 3:
        pose = Pose(pose.position, np.tile([1.0, 0.0, 0.0, 0.0], (201, 1)))
    contacts = detect(bodies, pose)
    first = contacts.body_a == 0
    np.testing.assert_allclose(contacts.gap[first], shape.signed_distance(centres) - 0.02, rtol=0, atol=1e-13)
    assert np.isnan(contacts.radius_a[first]).all()
    assert np.all(contacts.radius_b == 0.02)


@DIMENSIONS
@pytest.mark.parametrize("gap", [0.3, 1e-3, -0.002])
def test_agrees_with_the_naive_detector(dimension: int, gap: float) -> None:
    random = np.random.default_rng(11)
    wall = Wall(2, "bottom", Plane(np.full(dimension, -0.4), np.eye(dimension)[1]))
    bodies: list[Body] = [ellipsoid(*SHAPES[dimension][0]), ellipsoid(*SHAPES[dimension][1])]
    pose = placed_at(gap, bodies, turned(random, dimension), np.array([0.6, 0.8, 0.0])[:dimension])
    naive = BruteForceDetector(BruteForceOptions(), bodies, [wall]).detect(pose, None, np.inf)
    contacts = detect(bodies, pose, (wall,))
    np.testing.assert_array_equal(contacts.body_a, naive.body_a)
    np.testing.assert_array_equal(contacts.body_b, naive.body_b)
    np.testing.assert_array_equal(contacts.radius_b, naive.radius_b)
    np.testing.assert_allclose(contacts.gap, naive.gap, rtol=0, atol=1e-11)
    for field in ("point_a", "point_b", "normal"):
        np.testing.assert_allclose(getattr(contacts, field), getattr(naive, field), rtol=0, atol=2e-6)


@DIMENSIONS
def test_the_order_of_the_bodies_does_not_matter(dimension: int) -> None:
    for apart in ((1.0, 2.5), (0.1, 0.9)):
        for bodies, pose in random_pairs(dimension, apart, seed=4):
            one = detect(bodies, pose)
            other = detect(bodies[::-1], Pose(pose.position[::-1], pose.orientation[::-1]))
            assert one.gap[0] == pytest.approx(other.gap[0], abs=1e-14)
            np.testing.assert_allclose(one.normal, -other.normal, rtol=0, atol=1e-10)


@DIMENSIONS
@pytest.mark.parametrize("apart", [(1.9, 2.4), (0.3, 1.2)])
def test_the_gap_grows_as_its_normal_and_arm_say(dimension: int, apart: tuple[float, float]) -> None:
    """d gap = n·dx for a shift of a, and (r × n)·dφ for a turn about its centre, r from there to its point."""
    turns, step = 1 if dimension == 2 else 3, 1e-5
    for bodies, pose in random_pairs(dimension, apart, seed=8):
        contacts = detect(bodies, pose)

        def gap_after(shift: FloatArray, turn: FloatArray) -> float:
            position, orientation = pose.position.copy(), pose.orientation.copy()  # noqa: B023
            position[0] += shift
            orientation[:1] = rotate(orientation[:1], turn[None])
            return float(detect(bodies, Pose(position, orientation)).gap[0])  # noqa: B023

        still, upright = np.zeros(dimension), np.zeros(turns)
        shifts, angles = step * np.eye(dimension), step * np.eye(turns)
        slope = [(gap_after(move, upright) - gap_after(-move, upright)) / (2 * step) for move in shifts]
        twist = [(gap_after(still, turn) - gap_after(still, -turn)) / (2 * step) for turn in angles]
        arm = contacts.point_a - pose.position[:1]
        np.testing.assert_allclose(slope, contacts.normal[0], rtol=0, atol=1e-5)
        np.testing.assert_allclose(twist, moment(arm, contacts.normal)[0], rtol=0, atol=1e-5)


def test_an_ellipse_over_the_crest_of_a_bump_points_at_it() -> None:
    domain = Stenosis(StenosisOptions(length=12.0, width=5.0, radius=2.0, throat=2.0), 2)
    bump = next(wall for wall in surfaces_of(domain, 1) if wall.name == "bottom_bump")
    contacts = detect([ellipsoid(0.3, 0.2)], Pose(np.array([[0.0, -0.7]]), np.zeros((1, 1))), (bump,))
    np.testing.assert_allclose(contacts.gap, [0.1], rtol=1e-12)
    np.testing.assert_allclose(contacts.point_a, [[0.0, -0.9]], atol=1e-12)
    np.testing.assert_allclose(contacts.point_b, [[0.0, -1.0]], atol=1e-12)


@DIMENSIONS
def test_what_is_beyond_reach_is_left_out_and_nothing_else(dimension: int) -> None:
    random, count = np.random.default_rng(0), 60
    bodies = [ellipsoid(*SHAPES[dimension][k % len(SHAPES[dimension])]) for k in range(count)]
    pose = Pose(random.uniform(0, 6, (count, dimension)), turned(random, dimension, count))
    walls = tuple(Wall(count + k, "", Plane(np.zeros(dimension), np.eye(dimension)[k])) for k in range(dimension))
    everything = detect(bodies, pose, walls)
    assert len(everything) == count * (count - 1) // 2 + dimension * count
    for reach in (0.3, 0.0, -0.1):
        near, within = detect(bodies, pose, walls, reach), everything.gap <= reach
        assert 5 < np.count_nonzero(within) < len(everything) / 2
        expected = select(everything, within)
        for field in type(near).__slots__:
            np.testing.assert_array_equal(getattr(near, field), getattr(expected, field))


@DIMENSIONS
def test_without_bodies_there_is_no_contact(dimension: int) -> None:
    nobody = Pose(np.zeros((0, dimension)), np.zeros((0, 1 if dimension == 2 else 4)))
    contacts = detect([], nobody, (Wall(0, "", Plane(np.zeros(dimension), np.eye(dimension)[0])),))
    assert len(contacts) == 0
    assert contacts.normal.shape == (0, dimension)


@pytest.mark.parametrize(("place", "angle"), [(1e200, 0.0), (1.6, np.nan)])
def test_a_pair_without_a_normal_is_named(place: float, angle: float) -> None:
    pose = Pose(np.array([[0.0, 0.0], [place, 0.0]]), np.array([[0.0], [angle]]))
    with np.errstate(over="ignore"), pytest.raises(StepError, match=r"bodies 0 and 1: found no common normal"):
        detect([ellipsoid(1.0, 0.5)] * 2, pose)


def test_one_body_and_its_walls_need_no_compiler() -> None:
    code = """
import sys
import numpy as np
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.model.types import Pose
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.registry import BODY, DETECTOR, Registry
shape, detector = Registry.load().get(BODY, "ellipsoid"), Registry.load().get(DETECTOR, "ellipsoid")
bodies = [shape(shape.Options(semi_axes=[1.0, 0.5]), 2)]
walls = [Wall(1, "bottom", Plane(np.zeros(2), np.array([0.0, 1.0])))]
found = detector(PartOptions(), bodies, walls).detect(Pose(np.array([[0.0, 0.8]]), np.zeros((1, 1))), None, np.inf)
print(len(found), "numba" in sys.modules)
"""
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said == "1 False\n"


def test_other_shapes_are_refused_by_number_with_a_remedy() -> None:
    bodies = [ball(1.0), Cross(SphereOptions(radius=1.0), 2)]
    with pytest.raises(SceneError, match=r'contact\.detector: .*body\.1 of type "cross".*auto'):
        EllipsoidDetector(PartOptions(), bodies, [])
