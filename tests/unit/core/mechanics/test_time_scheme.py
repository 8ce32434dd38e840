import numpy as np
import pytest

from rigidfluid.core.mechanics.rigid import lab_inertia, rotation_matrices
from rigidfluid.core.mechanics.time_scheme import (
    derivative_weights,
    extrapolation_weights,
    newton_euler,
    path_error_weight,
    predict_pose,
    start_pose,
)
from rigidfluid.core.model.types import Pose, Twist, Wrench

UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]])


@pytest.mark.parametrize(("step", "previous"), [(0.1, 0.1), (0.1, 0.03), (0.1, 0.4)])
def test_derivative_is_exact_for_parabolas(step: float, previous: float) -> None:
    times = np.array([0.0, -step, -step - previous])
    weights = derivative_weights(step, previous)
    for power, slope in ((0, 0.0), (1, 1.0), (2, 2.0)):
        # about t = 1, so that every weight counts
        assert weights @ (1 + times) ** power == pytest.approx(slope, abs=1e-12)


def test_constant_steps_give_the_classical_weights() -> None:
    np.testing.assert_allclose(derivative_weights(0.5, 0.5), [3.0, -4.0, 1.0], rtol=1e-15)


def test_first_step_is_backward_euler() -> None:
    np.testing.assert_allclose(derivative_weights(0.5, None), [2.0, -2.0, 0.0], rtol=1e-15)
    np.testing.assert_array_equal(extrapolation_weights(0.5, None), [1.0, 0.0])


@pytest.mark.parametrize("previous", [0.1, 0.03])
def test_extrapolation_is_exact_for_lines(previous: float) -> None:
    weights = extrapolation_weights(0.1, previous)
    assert weights @ [1.0, 1.0] == pytest.approx(1.0)
    assert weights @ [0.0, -previous] == pytest.approx(0.1)


@pytest.mark.parametrize("previous", [0.1, 0.05, 0.2, 0.03])
def test_the_path_error_is_exact_for_parabolic_twists(previous: float) -> None:
    """Of a pose by Adams–Bashforth 2, from the three velocities alone."""
    step = 0.1

    def velocity(time: float) -> float:
        return 1.0 + 4.0 * time - 7.0 * time**2

    def twist(time: float) -> Twist:
        return Twist(np.full((1, 2), velocity(time)), np.zeros((1, 1)))

    start = Pose(np.zeros((1, 2)), np.zeros((1, 1)))
    pose = predict_pose(start, twist(0.0), twist(-previous), step, previous)
    way = step + 2.0 * step**2 - 7.0 / 3.0 * step**3
    differs = velocity(step) - extrapolation_weights(step, previous) @ [velocity(0.0), velocity(-previous)]
    found = path_error_weight(step, previous) * differs
    np.testing.assert_allclose((way - pose.position) / step, found, rtol=1e-12)


def test_the_path_error_of_equal_steps_is_that_of_adams_and_bashforth() -> None:
    assert path_error_weight(0.1, 0.1) == pytest.approx(5 / 12)


@pytest.mark.parametrize("previous", [0.1, 0.03])
@pytest.mark.parametrize("dimension", [2, 3])
def test_pose_is_exact_for_linear_twists(dimension: int, previous: float) -> None:
    step, spin = 0.1, np.eye(1, 1 if dimension == 2 else 3)

    def twist(time: float) -> Twist:
        return Twist(np.full((1, dimension), 1 + 4 * time), (2 + 3 * time) * spin)

    start = Pose(np.zeros((1, dimension)), np.zeros((1, 1)) if dimension == 2 else UPRIGHT)
    pose = predict_pose(start, twist(0.0), twist(-previous), step, previous)
    np.testing.assert_allclose(pose.position, step + 2 * step**2, rtol=1e-14)
    angle = 2 * step + 1.5 * step**2
    expected = [[angle]] if dimension == 2 else [[np.cos(angle / 2), np.sin(angle / 2), 0.0, 0.0]]
    np.testing.assert_allclose(pose.orientation, expected, rtol=0, atol=1e-15)


def test_the_pose_of_a_first_step_is_exact_for_twists_that_change_linearly_in_it() -> None:
    """From U = (1, 2) and ω = 3 to (3, -4) and 9 in .1."""
    start, end = (Twist(np.array([row[:2]]), np.array([row[2:]])) for row in ([1.0, 2.0, 3.0], [3.0, -4.0, 9.0]))
    pose = start_pose(Pose(np.zeros((1, 2)), np.zeros((1, 1))), start, end, 0.1)
    np.testing.assert_allclose(pose.position, [[0.2, -0.1]])
    np.testing.assert_allclose(pose.orientation, [[0.6]])


def test_first_pose_is_forward_euler() -> None:
    twist = Twist(np.array([[1.0, 2.0]]), np.array([[3.0]]))
    pose = predict_pose(Pose(np.zeros((1, 2)), np.zeros((1, 1))), twist, None, 0.1, None)
    np.testing.assert_allclose(pose.position, [[0.1, 0.2]])
    np.testing.assert_allclose(pose.orientation, [[0.3]])


def test_newton_euler_differences_the_momentum_of_each_time() -> None:
    random = np.random.default_rng(1)
    mass, inertia = np.array([2.0]), np.diag([1.0, 2.0, 3.0])[None]
    orientations = random.normal(size=(3, 1, 4))
    orientations /= np.linalg.norm(orientations, axis=2, keepdims=True)
    new, now, old = (Pose(np.zeros((1, 3)), orientation) for orientation in orientations)
    twists = [Twist(random.normal(size=(1, 3)), random.normal(size=(1, 3))) for _ in range(3)]
    wrench = Wrench(np.array([[1.0, 2.0, 3.0]]), np.array([[4.0, 5.0, 6.0]]))
    weights = np.array([3.0, -4.0, 1.0])
    matrix, load = newton_euler(mass, inertia, new, [now, old], twists[1:], weights, wrench)

    residual = matrix[0] @ np.append(twists[0].velocity, twists[0].angular_velocity) - load[0]
    spins = [
        rotation_matrices(pose.orientation)[0] @ inertia[0] @ rotation_matrices(pose.orientation)[0].T
        @ twist.angular_velocity[0]
        for pose, twist in zip((new, now, old), twists, strict=True)
    ]  # fmt: skip
    momenta = [np.append(2.0 * twist.velocity, spin) for twist, spin in zip(twists, spins, strict=True)]
    np.testing.assert_allclose(residual, weights @ momenta - [1, 2, 3, 4, 5, 6], rtol=0, atol=1e-13)
    np.testing.assert_allclose(matrix[0, 3:, 3:], 3 * lab_inertia(inertia, new.orientation)[0], rtol=1e-14)
    assert not matrix[0, :3, 3:].any()
    assert not matrix[0, 3:, :3].any()


def test_newton_euler_starts_from_one_past_twist() -> None:
    pose = Pose(np.zeros((1, 2)), np.zeros((1, 1)))
    nothing = Wrench(np.zeros((1, 2)), np.zeros((1, 1)))
    twist = Twist(np.array([[1.0, 2.0]]), np.array([[3.0]]))
    weights = derivative_weights(0.5, None)
    _, load = newton_euler(np.array([2.0]), np.array([[[5.0]]]), pose, [pose], [twist], weights, nothing)
    np.testing.assert_allclose(load, [[4.0, 8.0, 30.0]])
