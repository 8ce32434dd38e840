import numpy as np
import pytest

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.errors import SceneError


def detector_of(radii: FloatArray, dimension: int, walls: tuple[Wall, ...] = ()) -> SphereDetector:
    bodies = [Sphere(SphereOptions(radius=float(radius)), dimension) for radius in radii]
    return SphereDetector(PartOptions(), bodies, walls)


def pose_of(position: FloatArray) -> Pose:
    return Pose(position, np.zeros((len(position), 1 if position.shape[1] == 2 else 4)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_search_tree_finds_what_all_pairs_find(dimension: int) -> None:
    random = np.random.default_rng(0)
    radii, position = random.uniform(0.1, 0.5, 300), random.uniform(0, 8, (300, dimension))
    detector, reach = detector_of(radii, dimension), 0.2
    everything, near = detector.detect(pose_of(position), None, np.inf), detector.detect(pose_of(position), None, reach)
    assert len(everything) == 300 * 299 // 2
    within = everything.gap <= reach
    assert 50 < np.count_nonzero(within) < len(everything) / 2
    expected = select(everything, within)
    for field in type(near).__slots__:
        np.testing.assert_array_equal(getattr(near, field), getattr(expected, field))


def test_ten_thousand_balls_in_a_lattice() -> None:
    grid = np.stack(np.meshgrid(*[np.arange(100.0)] * 2), axis=-1).reshape(-1, 2)
    wall = Wall(10_000, "left", Plane(np.array([-0.6, 0.0]), np.array([1.0, 0.0])))
    contacts = detector_of(np.full(10_000, 0.45), 2, (wall,)).detect(pose_of(grid), None, 0.2)
    assert len(contacts) == 2 * 99 * 100 + 100
    np.testing.assert_allclose(contacts.gap[contacts.body_b < 10_000], 0.1, rtol=1e-12)
    assert np.all(np.diff(contacts.body_a) >= 0)


@pytest.mark.parametrize("reach", [0.1, np.inf])
@pytest.mark.parametrize("count", [0, 1])
def test_no_pair_no_contact(count: int, reach: float) -> None:
    contacts = detector_of(np.ones(count), 2).detect(pose_of(np.zeros((count, 2))), None, reach)
    assert len(contacts) == 0
    assert contacts.normal.shape == (0, 2)


def test_imaginary_ball_touches_the_wall_from_outside() -> None:
    wall = Wall(1, "bottom", Plane(np.array([5.0, -1.0]), np.array([0.0, 1.0])))
    contacts = detector_of(np.array([0.3]), 2, (wall,)).detect(pose_of(np.array([[2.0, -0.6]])), None, np.inf)
    centre, imaginary = contacts.point_a + 0.3 * contacts.normal, contacts.point_b - 0.3 * contacts.normal
    np.testing.assert_allclose(imaginary, [[2.0, -1.3]], rtol=0, atol=1e-15)
    np.testing.assert_allclose(contacts.gap, np.linalg.norm(centre - imaginary) - 2 * 0.3, rtol=0, atol=1e-15)


def test_a_ball_behind_the_wall_overlaps_it() -> None:
    wall = Wall(1, "bottom", Plane(np.zeros(2), np.array([0.0, 1.0])))
    contacts = detector_of(np.array([0.3]), 2, (wall,)).detect(pose_of(np.array([[0.0, -2.0]])), None, 0.0)
    np.testing.assert_allclose(contacts.gap, [-2.3])


def test_common_centre_still_has_a_unit_normal() -> None:
    contacts = detector_of(np.array([0.3, 0.4]), 3).detect(pose_of(np.ones((2, 3))), None, 0.0)
    np.testing.assert_allclose(contacts.gap, [-0.7])
    np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), [1.0])


def test_other_shapes_are_refused_by_number_with_a_remedy() -> None:
    bodies = [Sphere(SphereOptions(radius=1.0), 2), Ellipsoid(EllipsoidOptions(semi_axes=[1.0, 2.0]), 2)]
    with pytest.raises(SceneError, match=r'contact\.detector: .*body\.1 of type "ellipsoid".*auto'):
        SphereDetector(PartOptions(), bodies, [])


@pytest.mark.long
@pytest.mark.parametrize("dimension", [2, 3])
def test_kept_neighbours_find_what_a_new_search_finds(dimension: int) -> None:
    random = np.random.default_rng(1)
    radii, position = random.uniform(0.1, 0.3, 200), random.uniform(0, 5, (200, dimension))
    walls = tuple(
        Wall(200 + 2 * axis, "left", Plane(np.zeros(dimension), np.eye(dimension)[axis])) for axis in range(dimension)
    )
    kept = detector_of(radii, dimension, walls)
    velocity, searched = random.normal(size=(200, dimension)), 0
    for step in range(60):
        position = position + 0.004 * velocity
        before = kept._pairs._lists
        for reach in (0.05, 0.02 * step):
            found = kept.detect(pose_of(position), None, reach)
            fresh = detector_of(radii, dimension, walls).detect(pose_of(position), None, reach)
            for field in type(found).__slots__:
                np.testing.assert_array_equal(getattr(found, field), getattr(fresh, field))
        searched += kept._pairs._lists is not before
    assert 2 < searched < 40


def test_jump_beyond_the_kept_neighbours_is_noticed() -> None:
    position = np.stack([np.arange(100.0), np.zeros(100)], axis=1)
    detector = detector_of(np.full(100, 0.1), 2)
    assert len(detector.detect(pose_of(position), None, 0.01)) == 0
    position[0] = [99.0, 0.205]
    assert detector.detect(pose_of(position), None, 0.01).body_b.tolist() == [99]
