"""The detector "coal" against its contract and closed forms."""

from __future__ import annotations

import subprocess
import sys

import coal
import numpy as np
import pytest

from rigidfluid.api import (
    DETECTOR,
    Body,
    Ellipsoid,
    EllipsoidOptions,
    FloatArray,
    PartOptions,
    Plane,
    Pose,
    Registry,
    SceneError,
    Sphere,
    SphereOptions,
    Wall,
    rotation_matrices,
)
from rigidfluid.testing import Arrangement, DetectorContract
from rigidfluid_coal import CoalDetector


class TestCoalDetector(DetectorContract):
    gap_tolerance = 1e-14
    point_tolerance = 1e-13

    def make_detector(self, arrangement: Arrangement) -> CoalDetector:
        return CoalDetector(PartOptions(), arrangement.bodies, arrangement.walls)


def ellipsoid(*axes: float) -> Ellipsoid:
    return Ellipsoid(EllipsoidOptions(semi_axes=list(map(float, axes))), len(axes))


def scattered(dimension: int, count: int, seed: int) -> tuple[list[Body], Pose]:
    """Ellipsoids of aspect ratio up to 5, and one ball, crowded in a box of side 3."""
    random = np.random.default_rng(seed)
    bodies: list[Body] = [ellipsoid(*random.uniform(0.1, 0.5, dimension)) for _ in range(count - 1)]
    bodies.append(Sphere(SphereOptions(radius=0.3), dimension))
    turns = random.normal(size=(count, 1 if dimension == 2 else 4))
    if dimension == 3:
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return bodies, Pose(random.uniform(0.0, 3.0 if dimension == 2 else 2.0, (count, dimension)), turns)


def highest_separation(a: FloatArray, b: FloatArray, offset: FloatArray, turn_a: float, turn_b: float) -> float:
    """The gap of two ellipses from 200,000 directions."""
    angle = np.linspace(0, 2 * np.pi, 200_001)
    directions = np.stack([np.cos(angle), np.sin(angle)])
    turned = rotation_matrices(np.array([[turn_a], [turn_b]]))
    extent_a, extent_b = (
        np.linalg.norm(axes[:, None] * (turn.T @ directions), axis=0) for axes, turn in zip((a, b), turned, strict=True)
    )
    return float(np.max(offset @ directions - extent_a - extent_b))


@pytest.mark.parametrize("gap", [0.3, 1e-3, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-6, -1e-3, -0.05])
def test_gap_is_right_however_near(gap: float) -> None:
    """Two ellipses that face each other along x at this gap, turned as one: where coal alone loses the normal."""
    tip, side = ellipsoid(1.0, 0.25), ellipsoid(0.2, 0.8)
    turn = 0.7
    along = rotation_matrices(np.array([[turn]]))[0] @ np.array([1.2 + gap, 0.0])
    pose = Pose(np.stack([along, np.zeros(2)]), np.array([[turn], [turn]]))
    (found,) = [CoalDetector(PartOptions(), [tip, side], []).detect(pose, None, 1.0)]
    np.testing.assert_allclose(found.gap, [gap], rtol=0, atol=1e-15)
    np.testing.assert_allclose(found.normal[0], along / np.linalg.norm(along), rtol=0, atol=1e-14)


def test_gaps_and_deep_overlaps_of_ellipses_are_the_shortest_way_apart() -> None:
    random = np.random.default_rng(11)
    for _ in range(60):
        a, b = random.uniform(0.1, 1.0, (2, 2))
        offset, turns = random.normal(size=2), random.uniform(0, 6, 2)
        pose = Pose(np.stack([offset, np.zeros(2)]), turns[:, None])
        found = CoalDetector(PartOptions(), [ellipsoid(*a), ellipsoid(*b)], []).detect(pose, None, np.inf)
        np.testing.assert_allclose(found.gap, [highest_separation(a, b, offset, *turns)], rtol=0, atol=1e-8)


def test_walls_agree_with_coal_on_a_half_space() -> None:
    bodies, pose = scattered(3, 6, seed=5)
    plane = Plane(np.array([0.2, 0.0, -0.1]), np.array([2.0, 1.0, 2.0]) / 3)
    wall = Wall(len(bodies), "slope", plane)
    found = CoalDetector(PartOptions(), bodies, [wall]).detect(pose, None, np.inf)
    ground = coal.Halfspace(plane.unit_normal, float(plane.unit_normal @ plane.point))
    here = coal.Transform3s.Identity()
    for number, rotation in enumerate(rotation_matrices(pose.orientation)[:-1]):
        shape = coal.Ellipsoid(*bodies[number].options.model_dump()["semi_axes"])
        place = coal.Transform3s(rotation, pose.position[number])
        expected = coal.distance(shape, place, ground, here, coal.DistanceRequest(), coal.DistanceResult())
        row = (found.body_a == number) & (found.body_b == wall.surface)
        np.testing.assert_allclose(found.gap[row], [expected], rtol=0, atol=1e-14)


def test_balls_with_a_common_centre() -> None:
    balls = [Sphere(SphereOptions(radius=radius), 2) for radius in (0.4, 0.3)]
    found = CoalDetector(PartOptions(), balls, []).detect(Pose(np.ones((2, 2)), np.zeros((2, 1))), None, 0.0)
    np.testing.assert_allclose(found.gap, [-0.7])
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=1), 1.0)


def test_other_shapes_are_refused() -> None:
    class Cross(Sphere):
        name = "cross"
        radius = None  # type: ignore[assignment]
        volume = bounding_radius = 1.0  # type: ignore[assignment]
        unit_inertia = np.eye(1)  # type: ignore[assignment]

    with pytest.raises(SceneError, match=r'body\.0 of type "cross".*brute_force'):
        CoalDetector(PartOptions(), [Cross(SphereOptions(radius=1.0), 2)], [])


def test_it_is_found_by_name() -> None:
    assert Registry.load().get(DETECTOR, "coal") is CoalDetector


def test_without_coal_it_is_listed_with_what_to_install() -> None:
    code = (
        "import sys, importlib.util as util; find = util.find_spec\n"
        "util.find_spec = lambda name, *rest: None if name == 'coal' else find(name, *rest)\n"
        "from rigidfluid.api import Registry\n"
        "print(*[entry.hint for entry in Registry.load().entries if entry.name == 'coal'], 'coal' in sys.modules)"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert said == "Package coal is missing: install coal (`pip install coal`). False\n"
