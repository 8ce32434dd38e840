import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigidfluid.core.mechanics.rigid import (
    angle_between,
    angular_momentum,
    compose,
    cross,
    lab_inertia,
    moment,
    rotate,
    rotation_between,
    rotation_matrices,
)

RANDOM = np.random.default_rng(0)
QUATERNIONS = Rotation.random(20, rng=RANDOM).as_quat(scalar_first=True)
VECTORS = RANDOM.normal(size=(20, 3))


def test_quaternions_turn_vectors_as_scipy_does() -> None:
    expected = Rotation.from_quat(QUATERNIONS, scalar_first=True).as_matrix()
    np.testing.assert_allclose(rotation_matrices(QUATERNIONS), expected, rtol=0, atol=1e-14)


def test_an_angle_turns_counter_clockwise() -> None:
    turned = rotation_matrices(np.array([[np.pi / 2]]))[0] @ [1.0, 0.0]
    np.testing.assert_allclose(turned, [0.0, 1.0], rtol=0, atol=1e-15)


def test_rotate_composes_in_the_lab_frame() -> None:
    expected = Rotation.from_rotvec(VECTORS) * Rotation.from_quat(QUATERNIONS, scalar_first=True)
    found = rotation_matrices(rotate(QUATERNIONS, VECTORS))
    np.testing.assert_allclose(found, expected.as_matrix(), rtol=0, atol=1e-14)


def test_a_turn_in_a_turned_frame_comes_first() -> None:
    first, second = (rotate(np.eye(1, 4), np.array([turn])) for turn in ([0.3, -0.5, 0.7], [1.1, 0.2, -0.4]))
    whole = rotation_matrices(first) @ rotation_matrices(second)
    np.testing.assert_allclose(rotation_matrices(compose(first, second)), whole, atol=1e-15)
    np.testing.assert_allclose(compose(np.array([[0.3]]), np.array([[0.5]])), [[0.8]])


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-12])
def test_rotate_by_almost_nothing(size: float) -> None:
    np.testing.assert_allclose(rotate(QUATERNIONS, size * VECTORS), QUATERNIONS, rtol=0, atol=1e-11)


def test_quaternions_stay_normalised() -> None:
    orientation = 1.001 * QUATERNIONS
    for _ in range(100):
        orientation = rotate(orientation, 0.1 * VECTORS)
    np.testing.assert_allclose(np.linalg.norm(orientation, axis=1), 1.0, rtol=0, atol=1e-15)


def test_whole_turns_are_kept_in_the_plane() -> None:
    np.testing.assert_allclose(rotate(np.array([[3.0]]), np.array([[10.0]])), [[13.0]])


def test_cross_and_moment_in_the_plane_are_those_of_space() -> None:
    spin, arm, force = RANDOM.normal(size=(5, 1)), RANDOM.normal(size=(5, 2)), RANDOM.normal(size=(5, 2))
    lifted = np.hstack([np.zeros((5, 2)), spin])
    flat = np.zeros((5, 1))
    arm_3d, force_3d = np.hstack([arm, flat]), np.hstack([force, flat])
    np.testing.assert_allclose(cross(spin, arm), cross(lifted, arm_3d)[:, :2])
    np.testing.assert_allclose(moment(arm, force)[:, 0], moment(arm_3d, force_3d)[:, 2])


def test_cross_and_moment_in_space_are_right_handed() -> None:
    x, y, z = np.eye(3)
    np.testing.assert_array_equal(cross(z, x), y)
    np.testing.assert_array_equal(moment(x, y), z)


@pytest.mark.parametrize("shape", [(4, 7), (1, 1), (0,)])
@pytest.mark.parametrize("dimension", [2, 3])
def test_cross_and_moment_keep_leading_axes(shape: tuple[int, ...], dimension: int) -> None:
    freedoms = 1 if dimension == 2 else 3
    assert cross(np.ones((*shape, freedoms)), np.ones((*shape, dimension))).shape == (*shape, dimension)
    assert moment(np.ones((*shape, dimension)), np.ones((*shape, dimension))).shape == (*shape, freedoms)


def test_lab_inertia_is_that_of_turned_point_masses() -> None:
    points = RANDOM.normal(size=(6, 3))

    def inertia(positions: np.ndarray) -> np.ndarray:
        return np.sum(positions**2) * np.eye(3) - positions.T @ positions

    turned = [inertia(points @ rotation.T) for rotation in rotation_matrices(QUATERNIONS)]
    own = np.tile(inertia(points), (len(QUATERNIONS), 1, 1))
    np.testing.assert_allclose(lab_inertia(own, QUATERNIONS), turned, rtol=1e-13, atol=1e-13)


def test_inertia_of_balls_alone_does_not_turn() -> None:
    """No digit of it: but among others they are turned as these are."""
    balls, others = np.tile(2.0 * np.eye(3), (20, 1, 1)), np.tile(np.diag([1.0, 2.0, 3.0]), (20, 1, 1))
    np.testing.assert_array_equal(lab_inertia(balls, QUATERNIONS), balls)
    both = np.concatenate([balls, others]), np.tile(QUATERNIONS, (2, 1))
    turned = lab_inertia(*both)
    np.testing.assert_allclose(turned[:20], balls, rtol=0, atol=1e-14)
    rotation = rotation_matrices(QUATERNIONS)
    np.testing.assert_allclose(turned[20:], rotation @ others @ rotation.swapaxes(1, 2), rtol=0, atol=1e-14)


def test_added_mass_turns_in_the_plane() -> None:
    quarter = np.array([[np.pi / 2]])
    np.testing.assert_allclose(lab_inertia(np.diag([1.0, 2.0])[None], quarter)[0], np.diag([2.0, 1.0]), atol=1e-15)


@pytest.mark.parametrize("moments", [(2.0, 2.0, 2.0), (1.0, 2.0, 3.0)])
def test_angular_momentum_is_the_inertia_times_the_angular_velocity(moments: tuple[float, ...]) -> None:
    own = np.tile(np.diag(moments), (20, 1, 1))
    expected = [matrix @ spin for matrix, spin in zip(lab_inertia(own, QUATERNIONS), VECTORS, strict=True)]
    np.testing.assert_allclose(angular_momentum(own, QUATERNIONS, VECTORS), expected, rtol=1e-14, atol=1e-14)
    np.testing.assert_array_equal(angular_momentum(np.array([[[2.0]]]), np.zeros((1, 1)), np.array([[3.0]])), [[6.0]])


def test_inertia_in_the_plane_does_not_turn() -> None:
    np.testing.assert_array_equal(lab_inertia(np.array([[[2.0]]]), np.array([[0.7]])), [[[2.0]]])


@pytest.mark.parametrize("components", [1, 4])
def test_no_bodies_at_all(components: int) -> None:
    nothing = np.zeros((0, components))
    dimension, freedoms = (2, 1) if components == 1 else (3, 3)
    assert rotation_matrices(nothing).shape == (0, dimension, dimension)
    assert rotate(nothing, np.zeros((0, freedoms))).shape == (0, components)
    assert lab_inertia(np.zeros((0, freedoms, freedoms)), nothing).shape == (0, freedoms, freedoms)


def test_rotation_between_is_what_was_turned_by() -> None:
    """By less than half a turn, and from a quaternion of either sign."""
    vectors = 0.5 * VECTORS / np.linalg.norm(VECTORS, axis=1, keepdims=True)
    for start in (QUATERNIONS, -QUATERNIONS):
        np.testing.assert_allclose(rotation_between(start, rotate(QUATERNIONS, vectors)), vectors, atol=1e-14)
    np.testing.assert_array_equal(rotation_between(QUATERNIONS, QUATERNIONS), np.zeros_like(vectors))
    np.testing.assert_array_equal(rotation_between(np.array([[3.0]]), np.array([[13.0]])), [[10.0]])


def test_angle_between_is_that_of_the_rotation() -> None:
    turned = rotate(QUATERNIONS, VECTORS)
    expected = Rotation.from_rotvec(VECTORS).magnitude()
    np.testing.assert_allclose(angle_between(QUATERNIONS, turned), expected, rtol=1e-12)
    np.testing.assert_allclose(angle_between(QUATERNIONS, -turned), expected, rtol=1e-12)


def test_angle_between_counts_whole_turns_in_the_plane() -> None:
    np.testing.assert_array_equal(angle_between(np.array([[1.0], [0.0]]), np.array([[-1.0], [7.0]])), [2.0, 7.0])
