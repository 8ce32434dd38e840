import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from rigidfluid.bodies.ellipsoid import Ellipsoid, EllipsoidOptions
from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Contacts, Pose
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions

TILT = 0.4


def ellipsoid(*semi_axes: float) -> Body:
    return Ellipsoid(EllipsoidOptions(semi_axes=list(semi_axes)), len(semi_axes))


def detect(bodies: list[Body], pose: Pose, walls: list[Wall] | None = None, reach: float = np.inf) -> Contacts:
    return BruteForceDetector(BruteForceOptions(), bodies, walls or []).detect(pose, None, reach)


def tilted(angle: float) -> FloatArray:
    """A quaternion that turns about the z axis."""
    return np.array([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])


@pytest.mark.parametrize("height", [1.0, 0.6, 0.5])
@pytest.mark.parametrize("semi_axes", [(1.0, 0.5), (1.0, 0.05), (1.0, 0.5, 0.2), (0.2, 0.6, 1.0)])
def test_tilted_ellipsoid_over_a_wall(semi_axes: tuple[float, ...], height: float) -> None:
    dimension = len(semi_axes)
    wall = Wall(1, "bottom", Plane(np.zeros(dimension), np.eye(dimension)[1]))
    orientation = np.array([[TILT]]) if dimension == 2 else tilted(TILT)[None]
    pose = Pose(height * np.eye(dimension)[1:2], orientation)
    contacts = detect([ellipsoid(*semi_axes)], pose, [wall])
    support = np.hypot(semi_axes[0] * np.sin(TILT), semi_axes[1] * np.cos(TILT))
    np.testing.assert_allclose(contacts.gap, [height - support], rtol=0, atol=1e-12)
    np.testing.assert_allclose(contacts.normal, np.eye(dimension)[1:2])
    assert np.isnan(contacts.radius_a[0])
    assert np.isinf(contacts.radius_b[0])


@pytest.mark.parametrize("apart", [0.3, 1e-3, 0.0, -0.02])
@pytest.mark.parametrize("dimension", [2, 3])
def test_tilted_ellipsoids_placed_at_a_known_gap(dimension: int, apart: float) -> None:
    shapes = [ellipsoid(1.0, 0.5), ellipsoid(0.8, 0.3)] if dimension == 2 else [
        ellipsoid(1.0, 0.5, 0.7), ellipsoid(0.8, 0.3, 0.2)]  # fmt: skip
    pose, normal, point_a = touching(shapes, apart)
    contacts = detect(shapes, pose)
    np.testing.assert_allclose(contacts.gap, [apart], rtol=0, atol=1e-12)
    np.testing.assert_allclose(contacts.point_a, point_a[None], rtol=0, atol=1e-6)
    np.testing.assert_allclose(contacts.normal, normal[None], rtol=0, atol=1e-6)
    along = contacts.gap[:, None] * contacts.normal
    np.testing.assert_allclose(contacts.point_a, contacts.point_b + along, rtol=0, atol=1e-12)


def touching(shapes: list[Body], apart: float) -> tuple[Pose, FloatArray, FloatArray]:
    """Two tilted ellipsoids whose nearest points face each other along a chosen normal, ``apart`` from each other."""
    dimension = shapes[0].dimension
    orientation = np.array([[TILT], [-1.1]]) if dimension == 2 else np.stack([tilted(TILT), tilted(-1.1)])
    normal = np.array([0.6, 0.8, 0.0])[:dimension]
    point_a, point_b = np.zeros(dimension), -apart * normal
    position = np.stack([
        point_a - support(shapes[0], orientation[0], -normal),
        point_b - support(shapes[1], orientation[1], normal),
    ])  # fmt: skip
    return Pose(position, orientation), normal, point_a


def support(shape: Body, orientation: FloatArray, direction: FloatArray) -> FloatArray:
    """The farthest point of an ellipsoid, D² n/|D n| in its own frame; for turns about z alone."""
    angle = orientation[0] if len(orientation) == 1 else 2 * np.arctan2(orientation[3], orientation[0])
    rotation = np.eye(len(direction))
    rotation[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    assert isinstance(shape, Ellipsoid)
    stretched = shape.semi_axes * (direction @ rotation)
    return np.asarray(rotation @ (shape.semi_axes * stretched / np.linalg.norm(stretched)))


def test_slender_ellipse_and_disk_against_a_search_over_the_angle() -> None:
    shapes = [ellipsoid(1.0, 0.05), Sphere(SphereOptions(radius=0.2), 2)]
    pose = Pose(np.array([[0.0, 0.0], [0.97, 0.3]]), np.zeros((2, 1)))

    def distance(angle: float) -> float:
        return float(np.hypot(np.cos(angle) - 0.97, 0.05 * np.sin(angle) - 0.3))

    expected = minimize_scalar(distance, bounds=(0.0, 1.5), method="bounded", options={"xatol": 1e-12}).fun - 0.2
    contacts = detect(shapes, pose)
    np.testing.assert_allclose(contacts.gap, [expected], rtol=0, atol=1e-10)
    assert np.isnan(contacts.radius_a[0])
    assert contacts.radius_b[0] == 0.2


def test_far_bodies_are_left_out() -> None:
    shapes = [ellipsoid(1.0, 0.5), ellipsoid(1.0, 0.5)]
    pose = Pose(np.array([[0.0, 0.0], [0.0, 1.5]]), np.zeros((2, 1)))
    assert len(detect(shapes, pose, reach=0.49)) == 0
    assert len(detect(shapes, pose, reach=0.51)) == 1
