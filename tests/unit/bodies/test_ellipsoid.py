import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import ArgumentError, SceneError


def ellipsoid(*semi_axes: float) -> Ellipsoid:
    return Ellipsoid(EllipsoidOptions(semi_axes=list(semi_axes)), len(semi_axes))


def feet_and_points(semi_axes: FloatArray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Surface points, and the points at ``depth`` times the least radius of curvature along their normals."""
    random = np.random.default_rng(0)
    unit = random.normal(size=(len(depth), len(semi_axes)))
    feet = semi_axes * unit / np.linalg.norm(unit, axis=1, keepdims=True)
    normals = feet / semi_axes**2
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return feet, feet + (depth * semi_axes.min() ** 2 / semi_axes.max())[:, None] * normals


@pytest.mark.parametrize(
    "semi_axes", [(1.0, 0.05), (0.05, 1.0), (1.0, 0.05, 0.05), (1.0, 0.3, 0.05), (2e-5, 1e-5, 1e-6)]
)
def test_point_off_a_known_foot_finds_it_again(semi_axes: tuple[float, ...]) -> None:
    # inside, a foot stays the nearest point up to the least radius of curvature; outside without limit
    depth = np.concatenate([np.linspace(-0.9, 0, 300), np.geomspace(1e-12, 1e6, 300)])
    feet, points = feet_and_points(np.array(semi_axes), depth)
    shape = ellipsoid(*semi_axes)
    distance = depth * min(semi_axes) ** 2 / max(semi_axes)
    size = np.maximum(np.abs(distance), max(semi_axes))
    # a foot is as well-conditioned as the distance to the centre of curvature allows
    np.testing.assert_allclose(np.abs(shape.signed_distance(points) - distance) / size, 0.0, rtol=0, atol=1e-14)
    error = np.linalg.norm(shape.closest_point(points) - feet, axis=1)
    np.testing.assert_allclose(error / size, 0.0, rtol=0, atol=1e-12)


@pytest.mark.parametrize("semi_axes", [(1.0, 0.05), (0.05, 1.0), (3.0, 2.0)])
def test_points_on_the_axes_against_a_search_over_the_angle(semi_axes: tuple[float, float]) -> None:
    shape, axes = ellipsoid(*semi_axes), np.array(semi_axes)
    shares = np.array([0.0, 1e-9, 0.3, 0.9, 0.99, 0.9975, 1.0, 1.5])
    for point in np.concatenate([shares[:, None] * axis for axis in np.diag(axes)]):

        def square(angle: float, point: FloatArray = point) -> float:
            return float(np.sum((axes * [np.cos(angle), np.sin(angle)] - point) ** 2))

        angles = np.linspace(0, np.pi / 2, 2001)
        best = angles[np.argmin([square(angle) for angle in angles])]
        bracket = (best - 1e-3, best + 1e-3)
        least = minimize_scalar(square, bounds=bracket, method="bounded", options={"xatol": 1e-12}).fun
        assert abs(shape.signed_distance(point[None])[0]) == pytest.approx(np.sqrt(least), abs=1e-8)


def test_nearest_point_of_the_centre_is_on_the_shortest_axis() -> None:
    shape = ellipsoid(3.0, 1.0, 2.0)
    np.testing.assert_allclose(np.abs(shape.closest_point(np.zeros((1, 3)))), [[0.0, 1.0, 0.0]], rtol=0, atol=1e-15)
    assert shape.signed_distance(np.zeros((1, 3)))[0] == -1.0


def test_closest_point_depends_on_its_own_point_alone() -> None:
    shape, points = ellipsoid(1.0, 0.05, 0.3), np.random.default_rng(1).normal(size=(50, 3))
    one_by_one = np.concatenate([shape.closest_point(point[None]) for point in points])
    np.testing.assert_allclose(shape.closest_point(points), one_by_one, rtol=0, atol=1e-14)
    assert shape.closest_point(points[:0]).shape == (0, 3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_equal_axes_make_a_ball(dimension: int) -> None:
    ball, round_one = Sphere(SphereOptions(radius=0.3), dimension), ellipsoid(*[0.3] * dimension)
    assert round_one.radius == 0.3
    assert round_one.volume == pytest.approx(ball.volume, rel=1e-15)
    np.testing.assert_allclose(round_one.unit_inertia, ball.unit_inertia, rtol=1e-15)
    assert ellipsoid(0.3, 0.2).radius is None


def test_as_many_axes_as_dimensions() -> None:
    with pytest.raises(SceneError, match=r"body\.semi_axes.*a list of 3 lengths"):
        Ellipsoid(EllipsoidOptions(semi_axes=[1.0, 2.0]), 3)


@pytest.mark.parametrize("semi_axes", [[1.0], [1.0, 0.0], [1.0, -1.0], [1.0, float("inf")], [1.0] * 4])
def test_options_refuse_what_is_no_ellipsoid(semi_axes: list[float]) -> None:
    with pytest.raises(ArgumentError):
        EllipsoidOptions(semi_axes=semi_axes)


def test_options_refuse_what_is_no_ball() -> None:
    with pytest.raises(ArgumentError):
        SphereOptions(radius=0.0)
