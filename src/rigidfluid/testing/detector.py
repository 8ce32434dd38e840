"""What every detector must satisfy."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.bodies.sphere import Sphere, SphereOptions
from rigidfluid.core.interfaces import Body, Detector
from rigidfluid.core.types import Contacts, FloatArray, IntArray, Mesh, Pose, Wall


@dataclass(frozen=True)
class Arrangement:
    """Balls and walls for one test.

    ``radii`` (n,) and ``centres`` (n, d) of the balls [length]; ``wall_points`` and unit ``wall_normals`` (w, d);
    ``corners`` (2, d), opposite corners of a box that holds them [length]. Surfaces are numbered: the balls, the walls,
    then any further faces of the box.
    """

    radii: FloatArray
    centres: FloatArray
    wall_points: FloatArray
    wall_normals: FloatArray
    corners: FloatArray

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return int(self.centres.shape[1])

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The balls."""
        return tuple(Sphere(SphereOptions(radius=float(radius)), self.dimension) for radius in self.radii)

    @property
    def walls(self) -> tuple[Wall, ...]:
        """The walls, numbered after the balls."""
        rows = zip(self.wall_points, self.wall_normals, strict=True)
        first = len(self.radii)
        return tuple(Wall(first + index, f"wall {index}", *row) for index, row in enumerate(rows))

    @property
    def pose(self) -> Pose:
        """The balls' positions, not turned."""
        upright = np.eye(1, 1 if self.dimension == 2 else 4) * (self.dimension == 3)
        return Pose(self.centres, np.tile(upright, (len(self.radii), 1)))

    def moved(self, rotation: FloatArray, shift: FloatArray, scale: float = 1.0) -> Arrangement:
        """x → scale · R x + shift, walls and all."""
        return Arrangement(
            scale * self.radii,
            scale * self.centres @ rotation.T + shift,
            scale * self.wall_points @ rotation.T + shift,
            self.wall_normals @ rotation.T,
            scale * self.corners @ rotation.T + shift,
        )


class DetectorContract:
    """Contacts of balls and flat walls against their closed form.

    Override ``make_detector`` and, for a detector that reads the mesh, ``make_mesh``, the tolerances and ``rotation``.
    """

    gap_tolerance: ClassVar[float] = 1e-10
    """Accuracy of gaps, relative to balls of radius 0.25 to 0.4 [length]."""
    point_tolerance: ClassVar[float] = 1e-6
    """Accuracy of contact points and normals."""
    detects_overlap: ClassVar[bool] = True
    """Whether surfaces that overlap are found, with a negative gap."""
    reach: ClassVar[float] = 0.3
    """The reach of most tests [length]."""

    @pytest.fixture(params=[2, 3])
    def dimension(self, request: pytest.FixtureRequest) -> int:
        """Both numbers of space dimensions."""
        return int(request.param)

    def make_detector(self, arrangement: Arrangement) -> Detector:
        """The detector under test for these bodies and walls."""
        raise NotImplementedError("override `make_detector`")

    def make_mesh(self, arrangement: Arrangement) -> Mesh | None:
        """The mesh between these bodies and walls; None for a detector that needs none."""
        return None

    def rotation(self, dimension: int) -> FloatArray:
        """The rotation that must not change the gaps (a quarter turn keeps a box a box)."""
        return _rotation(dimension, angle=0.7)

    def detect(self, arrangement: Arrangement, reach: float) -> Contacts:
        """All contacts of an arrangement."""
        return self.make_detector(arrangement).detect(arrangement.pose, self.make_mesh(arrangement), reach)

    def test_gaps_of_balls_and_walls(self, dimension: int) -> None:
        """Exactly the pairs within reach, each with the closed form's gap."""
        arrangement = _apart(dimension)
        expected = _expected_gaps(arrangement, self.reach)
        contacts = self.detect(arrangement, self.reach)
        assert list(zip(contacts.body_a, contacts.body_b, strict=True)) == list(expected)
        np.testing.assert_allclose(contacts.gap, list(expected.values()), rtol=0, atol=self.gap_tolerance)

    def test_points_gap_and_normal_agree(self, dimension: int) -> None:
        """point_a = point_b + gap · normal, normals of length 1, and both points on their surfaces."""
        arrangement = _apart(dimension)
        contacts = self.detect(arrangement, self.reach)
        self._check_points(arrangement, contacts)

    def test_overlap_has_a_negative_gap(self, dimension: int) -> None:
        """Two overlapping balls, one of them sunk into a wall."""
        if not self.detects_overlap:
            pytest.skip("this detector does not see overlaps")
        arrangement = _overlapping(dimension)
        contacts = self.detect(arrangement, 0.0)
        expected = _expected_gaps(arrangement, 0.0)
        assert list(zip(contacts.body_a, contacts.body_b, strict=True)) == list(expected)
        np.testing.assert_allclose(contacts.gap, list(expected.values()), rtol=0, atol=self.gap_tolerance)
        self._check_points(arrangement, contacts)

    def test_radii_of_curvature(self, dimension: int) -> None:
        """Balls have their radius, flat walls an infinite one; NaN says that the detector does not know."""
        arrangement = _apart(dimension)
        contacts = self.detect(arrangement, self.reach)
        is_wall = contacts.body_b >= len(arrangement.radii)
        expected = np.append(arrangement.radii, np.full(len(arrangement.wall_points), np.inf))
        assert np.all(np.isinf(contacts.radius_b[is_wall]))
        for body, radius in ((contacts.body_a, contacts.radius_a), (contacts.body_b, contacts.radius_b)):
            known = ~np.isnan(radius)
            np.testing.assert_array_equal(radius[known], expected[body][known])

    def test_swapping_two_bodies_flips_the_normal(self, dimension: int) -> None:
        """The same gap, with a and b exchanged."""
        pair = _pair(dimension)
        swapped = replace(pair, radii=pair.radii[::-1], centres=pair.centres[::-1])
        one, other = self.detect(pair, self.reach), self.detect(swapped, self.reach)
        np.testing.assert_allclose(one.gap, other.gap, rtol=0, atol=self.gap_tolerance)
        np.testing.assert_allclose(one.normal, -other.normal, rtol=0, atol=self.point_tolerance)
        np.testing.assert_allclose(one.point_a, other.point_b, rtol=0, atol=self.point_tolerance)

    def test_normal_points_from_b_to_a(self, dimension: int) -> None:
        """For balls it is the line from centre b to centre a."""
        pair = _pair(dimension)
        contacts = self.detect(pair, self.reach)
        line = pair.centres[0] - pair.centres[1]
        np.testing.assert_allclose(contacts.normal, [line / np.linalg.norm(line)], rtol=0, atol=self.point_tolerance)

    def test_moves_with_the_frame(self, dimension: int) -> None:
        """A rigid motion keeps the gaps and carries points and normals along."""
        rotation, shift = self.rotation(dimension), np.array([3.0, -2.0, 1.0])[:dimension]
        contacts = self.detect(_apart(dimension), self.reach)
        moved = self.detect(_apart(dimension).moved(rotation, shift), self.reach)
        np.testing.assert_allclose(moved.gap, contacts.gap, rtol=0, atol=self.gap_tolerance)
        np.testing.assert_allclose(moved.normal, contacts.normal @ rotation.T, rtol=0, atol=self.point_tolerance)
        np.testing.assert_allclose(
            moved.point_a, contacts.point_a @ rotation.T + shift, rtol=0, atol=self.point_tolerance
        )

    def test_scales_with_the_lengths(self, dimension: int) -> None:
        """Nothing but ratios of lengths matters: micrometres do as well as metres."""
        scale = 1e-4
        small = _apart(dimension).moved(np.eye(dimension), np.zeros(dimension), scale)
        contacts = self.detect(_apart(dimension), self.reach)
        scaled = self.detect(small, scale * self.reach)
        np.testing.assert_allclose(scaled.gap / scale, contacts.gap, rtol=0, atol=self.gap_tolerance)
        np.testing.assert_allclose(scaled.normal, contacts.normal, rtol=0, atol=self.point_tolerance)

    def test_nothing_beyond_reach(self, dimension: int) -> None:
        """A pair is found just within reach and not just beyond."""
        pair = _pair(dimension)
        gap = next(iter(_expected_gaps(pair, np.inf).values()))
        margin = 2 * self.gap_tolerance
        assert len(self.detect(pair, gap + margin)) == 1
        nothing = self.detect(pair, gap - margin)
        assert len(nothing) == 0
        assert nothing.normal.shape == (0, dimension)

    def _check_points(self, arrangement: Arrangement, contacts: Contacts) -> None:
        along = contacts.gap[:, None] * contacts.normal
        np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1.0, rtol=0, atol=1e-9)
        np.testing.assert_allclose(contacts.point_a, contacts.point_b + along, rtol=0, atol=self.gap_tolerance)
        distances_a = _surface_distance(arrangement, contacts.body_a, contacts.point_a)
        distances_b = _surface_distance(arrangement, contacts.body_b, contacts.point_b)
        np.testing.assert_allclose(distances_a, 0.0, rtol=0, atol=self.gap_tolerance)
        np.testing.assert_allclose(distances_b, 0.0, rtol=0, atol=self.gap_tolerance)


def _apart(dimension: int) -> Arrangement:
    """Four balls of different size in the corner of two walls, most of them within reach of another."""
    centres = np.array([[0.62, 0.51, 0.5], [1.45, 0.63, 0.55], [1.1, 1.35, 0.45], [2.9, 2.7, 0.5]])
    return _arrangement([0.4, 0.3, 0.35, 0.25], centres, np.eye(3)[:2], dimension)


def _overlapping(dimension: int) -> Arrangement:
    return _arrangement([0.4, 0.3], np.array([[1.0, 0.35, 0.1], [1.5, 0.75, 0.2]]), np.eye(3)[1:2], dimension)


def _pair(dimension: int) -> Arrangement:
    return _arrangement([0.4, 0.3], np.array([[0.7, 0.6, 0.5], [1.3, 1.1, 0.8]]), np.zeros((0, 3)), dimension)


def _arrangement(radii: list[float], centres: FloatArray, normals: FloatArray, dimension: int) -> Arrangement:
    """Balls in a box from (0, 0, -1) to (4, 4, 2), all walls through the origin."""
    corners = np.array([[0.0, 0.0, -1.0], [4.0, 4.0, 2.0]])
    rows = (centres, np.zeros_like(normals), normals, corners)
    return Arrangement(np.array(radii), *(row[:, :dimension] for row in rows))


def _expected_gaps(arrangement: Arrangement, reach: float) -> dict[tuple[int, int], float]:
    """The closed form: |x_i - x_j| - r_i - r_j, and height minus radius; by (body_a, body_b), sorted."""
    count, gaps = len(arrangement.radii), {}
    for a in range(count):
        for b in range(a + 1, count):
            apart = np.linalg.norm(arrangement.centres[a] - arrangement.centres[b])
            gaps[a, b] = float(apart - arrangement.radii[a] - arrangement.radii[b])
        for wall in arrangement.walls:
            gaps[a, wall.surface] = float((arrangement.centres[a] - wall.point) @ wall.normal - arrangement.radii[a])
    return {pair: gap for pair, gap in gaps.items() if gap <= reach}


def _surface_distance(arrangement: Arrangement, surfaces: IntArray, points: FloatArray) -> FloatArray:
    """Signed distance of each point to the surface it should be on."""
    count = len(arrangement.radii)
    distances = [
        np.linalg.norm(point - arrangement.centres[surface]) - arrangement.radii[surface]
        if surface < count
        else (point - arrangement.walls[surface - count].point) @ arrangement.walls[surface - count].normal
        for surface, point in zip(surfaces, points, strict=True)
    ]
    return np.array(distances, dtype=float)


def _rotation(dimension: int, angle: float) -> FloatArray:
    """A turn about an axis that is none of the coordinate axes in 3D, in the plane in 2D."""
    if dimension == 2:
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    axis = np.array([1.0, 2.0, 2.0]) / 3
    skew = np.cross(np.eye(3), axis)
    return np.asarray(np.eye(3) - np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew)
