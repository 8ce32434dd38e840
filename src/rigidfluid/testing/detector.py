"""Contract tests of a detector."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import replace
from functools import cache
from typing import ClassVar

import numpy as np
import pytest

from rigidfluid.core.contact.path.detection import detection_by
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.piece import Piece
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.types import Contacts
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.testing.arrangement import (
    Arrangement,
    ball_pair,
    balls_apart,
    balls_overlapping,
    random_ellipsoids,
    single_ball,
    turn_matrix,
)

Pairs = list[tuple[int, int]]


class DetectorContract:
    """Contacts of balls against their closed form, of ellipsoids against ``brute_force``, and what holds for any shape.

    Override ``make_detector``. A detector on meshes gets a mesh of the fluid between the bodies; its gaps may
    be larger than those of the shapes by as much as the facets lie below the surfaces, h²/(8R) or so each.
    """

    gap_tolerance: ClassVar[float] = 1e-10
    """Accuracy of gaps and of contact points across the surface, among bodies of size 0.06 to 0.45 [length]."""
    point_tolerance: ClassVar[float] = 1e-6
    """Accuracy of contact points along the surface, and of normals."""
    detects_overlap: ClassVar[bool] = True
    """Tell whether surfaces that overlap are found, with a negative gap."""
    balls_only: ClassVar[bool] = False
    """Tell whether other shapes than balls are refused."""
    reach: ClassVar[float] = 0.5
    """The reach of most tests [length]."""

    @pytest.fixture(params=[2, 3])
    def dimension(self, request: pytest.FixtureRequest) -> int:
        """Both numbers of space dimensions."""
        return int(request.param)

    @pytest.fixture(params=[(2, 0), (2, 1), (3, 0)], ids=["2-first", "2-second", "3"])
    def ellipsoids(self, request: pytest.FixtureRequest) -> Arrangement:
        """Ellipsoids in a box; skips where the detector handles balls only."""
        if self.balls_only:
            pytest.skip("this detector handles balls only")
        return random_ellipsoids(*request.param)

    @pytest.fixture(params=["balls", "ellipsoids"])
    def arrangement(self, request: pytest.FixtureRequest, dimension: int) -> Arrangement:
        """Balls in the corner of two walls, and ellipsoids in a box where the detector handles them."""
        if request.param == "balls":
            return balls_apart(dimension)
        if self.balls_only:
            pytest.skip("this detector handles balls only")
        return random_ellipsoids(dimension, 0)

    def make_detector(self, arrangement: Arrangement) -> Detector:
        """The detector under test for these bodies and walls."""
        raise NotImplementedError("override `make_detector`")

    def detect(self, arrangement: Arrangement, reach: float) -> Contacts:
        """All contacts of an arrangement."""
        detector = self.make_detector(arrangement)
        mesh = detection_by(type(detector)).mesh_at(arrangement.pose, lambda pose: arrangement.mesh)
        return detector.detect(arrangement.pose, mesh, reach)

    def depths(self, arrangement: Arrangement) -> FloatArray:
        """Depth of the detector's surfaces below the true ones that is allowed, by body, and for walls 0 at the end.

        With a mesh that is the depth of the facets, h²/(8R) on a circle of radius R with edges h.
        """
        on_mesh = detection_by(type(self.make_detector(arrangement))).on_mesh
        return np.append(arrangement.depths if on_mesh else np.zeros(len(arrangement.semi_axes)), 0.0)

    def test_gaps_of_balls_and_walls(self, dimension: int) -> None:
        """Exactly the pairs within reach, sorted, each with the closed form's gap."""
        arrangement = balls_apart(dimension)
        self._check_gaps(arrangement, _ball_gaps(arrangement), self.reach)

    def test_reach_may_be_infinite(self, dimension: int) -> None:
        """Then every pair is found."""
        arrangement = ball_pair(dimension)
        self._check_gaps(arrangement, _ball_gaps(arrangement), np.inf)

    def test_gaps_of_ellipsoids_are_those_of_brute_force(self, ellipsoids: Arrangement) -> None:
        """Aspect ratios up to 5 at random tilts, each other and walls, against a search over both surfaces."""
        self._check_gaps(ellipsoids, _searched_gaps(ellipsoids, 1.01 * self.reach), self.reach)

    def test_exactness_holds_for_the_shapes_it_is_claimed_for(self, arrangement: Arrangement) -> None:
        """Claims of `exact_for`, on which ``auto`` relies: gaps to 1e-10, whatever ``gap_tolerance`` is."""
        pieces = [Piece(wall.name, wall.shape, math.inf) for wall in arrangement.walls]
        made = self.make_detector(arrangement)
        if made.exact_for(arrangement.bodies, pieces) is None:
            pytest.skip("this detector does not claim to be exact for these shapes")
        if detection_by(type(made)).on_mesh:
            pytest.skip("this detector is exact to the facets of its mesh")
        self._check_gaps(arrangement, _searched_gaps(arrangement, 1.01 * self.reach), self.reach, 1e-10)

    def test_exactness_is_not_claimed_for_refused_shapes(self) -> None:
        """With ``balls_only``: no claim of exactness for ellipsoids."""
        if not self.balls_only:
            pytest.skip("this detector takes other shapes than balls")
        balls = self.make_detector(single_ball(2))
        assert balls.exact_for(random_ellipsoids(2, 0).bodies, ()) is None

    def test_points_are_on_the_surfaces_and_a_gap_apart(self, arrangement: Arrangement) -> None:
        """point_a = point_b + gap · normal, normals of length 1, and both points on their surfaces."""
        contacts = self.detect(arrangement, self.reach)
        assert len(contacts) > 0
        self._check_points(arrangement, contacts)

    def test_contacts_are_sorted_and_within_reach(self, arrangement: Arrangement) -> None:
        """Rows are sorted by (body_a, body_b), body_a < body_b, walls counted after bodies; no gap exceeds reach."""
        contacts = self.detect(arrangement, self.reach)
        pairs = _pairs(contacts)
        assert len(pairs) > 1
        assert pairs == sorted(pairs)
        assert np.all(contacts.body_a < len(arrangement.bodies))
        assert np.all(contacts.body_a < contacts.body_b)
        assert np.all(contacts.gap <= self.reach)

    def test_nothing_beyond_reach(self, dimension: int) -> None:
        """A pair is found just within reach and not just beyond."""
        pair = ball_pair(dimension)
        (gap,) = _ball_gaps(pair).values()
        margin = 2 * self.gap_tolerance
        assert len(self.detect(pair, gap + self.depths(pair).sum() + margin)) == 1
        _check_empty(self.detect(pair, gap - margin), dimension)

    def test_nothing_near(self, dimension: int) -> None:
        """A body alone has no contacts, but arrays of the right shape."""
        _check_empty(self.detect(single_ball(dimension), self.reach), dimension)

    def test_a_shorter_reach_leaves_out_what_is_beyond(self, arrangement: Arrangement) -> None:
        """And changes nothing else: the loop takes contacts in a shorter reach from those in a longer one."""
        far = self.detect(arrangement, self.reach)
        reach = float(np.mean(np.sort(far.gap)[:2]))
        self._check_same(select(far, far.gap <= reach), self.detect(arrangement, reach))

    def test_contacts_stay_as_they_were_found(self, arrangement: Arrangement) -> None:
        """A later call leaves the arrays of an earlier one alone: the loop keeps them."""
        detector = self.make_detector(arrangement)
        mesh = detection_by(type(detector)).mesh_at(arrangement.pose, lambda pose: arrangement.mesh)
        found = detector.detect(arrangement.pose, mesh, self.reach)
        kept = deepcopy(found)
        detector.detect(arrangement.pose, mesh, float(np.mean(np.sort(found.gap)[:2])))
        for name in Contacts.__slots__:
            np.testing.assert_array_equal(getattr(found, name), getattr(kept, name), err_msg=name)

    def test_overlap_has_a_negative_gap(self, dimension: int) -> None:
        """Two overlapping balls, one of them sunk into a wall."""
        if not self.detects_overlap:
            pytest.skip("this detector does not see overlaps")
        arrangement = balls_overlapping(dimension)
        self._check_gaps(arrangement, _ball_gaps(arrangement), 0.0)
        self._check_points(arrangement, self.detect(arrangement, 0.0))

    def test_radii_of_curvature(self, dimension: int) -> None:
        """Balls have their radius, flat walls an infinite one; NaN says that the detector does not know."""
        arrangement = balls_apart(dimension)
        contacts = self.detect(arrangement, self.reach)
        count = len(arrangement.bodies)
        is_wall = contacts.body_b >= count
        np.testing.assert_array_equal(contacts.at_wall, is_wall)
        assert np.all(np.isinf(contacts.radius_b[is_wall]))
        expected = np.append(arrangement.semi_axes[:, 0], np.inf)
        for surface, radius in ((contacts.body_a, contacts.radius_a), (contacts.body_b, contacts.radius_b)):
            known = ~np.isnan(radius)
            np.testing.assert_array_equal(radius[known], expected[np.minimum(surface, count)][known])

    def test_normal_points_from_b_to_a(self, dimension: int) -> None:
        """For balls it is the line n from centre b to centre a.

        Points d below the surfaces are at least the true gap g apart along n and at most g + d_a + d_b in all, so that
        cos ≥ g/(g + d_a + d_b).
        """
        pair = ball_pair(dimension)
        contacts = self.detect(pair, self.reach)
        (gap,), depth = _ball_gaps(pair).values(), self.depths(pair).sum()
        line = pair.pose.position[0] - pair.pose.position[1]
        tolerance = self.point_tolerance + np.sqrt(2 * depth / (gap + depth))
        difference = np.linalg.norm(contacts.normal - line / np.linalg.norm(line), axis=1)
        assert difference.shape == (1,)
        assert difference[0] <= tolerance

    def test_swapping_two_bodies_flips_the_normal(self, arrangement: Arrangement) -> None:
        """The same gaps and points with a and b exchanged, all bodies in reverse order."""
        one, other = self.detect(arrangement, self.reach), self.detect(arrangement.reversed(), self.reach)
        self._check_same(one, _swapped(other, arrangement))

    def test_moves_with_the_frame(self, arrangement: Arrangement) -> None:
        """A rigid motion keeps the gaps and carries points and normals along."""
        turn = np.array([0.7]) if arrangement.dimension == 2 else 0.7 * np.array([1.0, 2.0, 2.0]) / 3
        shift, rotation = np.array([3.0, -2.0, 1.0])[: arrangement.dimension], turn_matrix(turn)
        moved = self.detect(arrangement.moved(turn, shift), self.reach)
        self._check_same(self.detect(arrangement, self.reach), _placed_back(moved, rotation, shift, 1.0))

    def test_scales_with_the_lengths(self, arrangement: Arrangement) -> None:
        """Nothing but ratios of lengths matters: nanometres do as well as metres."""
        scale, origin = 1e-9, np.zeros(arrangement.dimension)
        small = arrangement.moved(np.zeros(1 if arrangement.dimension == 2 else 3), origin, scale)
        found = _placed_back(self.detect(small, scale * self.reach), np.eye(arrangement.dimension), origin, scale)
        self._check_same(self.detect(arrangement, self.reach), found)

    def _check_gaps(
        self,
        arrangement: Arrangement,
        expected: dict[tuple[int, int], float],
        reach: float,
        tolerance: float | None = None,
    ) -> None:
        """Find every pair that is surely within reach, none that is beyond, each with the expected gap."""
        contacts = self.detect(arrangement, reach)
        pairs, depths = _pairs(contacts), self.depths(arrangement)
        slack = self.gap_tolerance if tolerance is None else tolerance
        excess = {pair: slack + depths[[min(surface, len(depths) - 1) for surface in pair]].sum() for pair in expected}
        assert len(pairs) > 0
        assert pairs == sorted(set(pairs))
        assert {pair for pair, gap in expected.items() if gap + excess[pair] <= reach} <= set(pairs)
        assert set(pairs) <= {pair for pair, gap in expected.items() if gap - slack <= reach}
        difference = contacts.gap - [expected[pair] for pair in pairs]
        assert np.all(difference >= -slack)
        assert np.all(difference <= [excess[pair] for pair in pairs])

    def _check_points(self, arrangement: Arrangement, contacts: Contacts) -> None:
        depths, slack = self.depths(arrangement), self.gap_tolerance
        along = contacts.gap[:, None] * contacts.normal
        np.testing.assert_allclose(np.linalg.norm(contacts.normal, axis=1), 1.0, rtol=0, atol=1e-9)
        np.testing.assert_allclose(contacts.point_a, contacts.point_b + along, rtol=0, atol=slack)
        for surfaces, points in ((contacts.body_a, contacts.point_a), (contacts.body_b, contacts.point_b)):
            height = arrangement.distances(surfaces, points)
            assert np.all(height <= slack)
            assert np.all(height >= -slack - depths[np.minimum(surfaces, len(depths) - 1)])

    def _check_same(self, expected: Contacts, found: Contacts) -> None:
        assert len(expected) > 0
        assert _pairs(found) == _pairs(expected)
        np.testing.assert_allclose(found.gap, expected.gap, rtol=0, atol=self.gap_tolerance)
        for name in ("normal", "point_a", "point_b"):
            same = getattr(found, name), getattr(expected, name)
            np.testing.assert_allclose(*same, rtol=0, atol=self.point_tolerance, err_msg=name)


def _ball_gaps(arrangement: Arrangement) -> dict[tuple[int, int], float]:
    """The closed form: |x_i - x_j| - r_i - r_j, and height minus radius, by (body_a, body_b)."""
    radii, centres, gaps = arrangement.semi_axes[:, 0], arrangement.pose.position, {}
    for a in range(len(radii)):
        for b in range(a + 1, len(radii)):
            gaps[a, b] = float(np.linalg.norm(centres[a] - centres[b]) - radii[a] - radii[b])
        for wall in arrangement.walls:
            gaps[a, wall.surface] = float(wall.shape.signed_distance(centres[a : a + 1])[0] - radii[a])
    return gaps


@cache
def _searched_gaps(arrangement: Arrangement, reach: float) -> dict[tuple[int, int], float]:
    """Gaps up to ``reach`` from a search over the surfaces, by (body_a, body_b)."""
    oracle = BruteForceDetector(BruteForceOptions(samples=400), arrangement.bodies, arrangement.walls)
    contacts = oracle.detect(arrangement.pose, None, reach)
    return dict(zip(_pairs(contacts), contacts.gap.tolist(), strict=True))


def _placed_back(contacts: Contacts, rotation: FloatArray, shift: FloatArray, scale: float) -> Contacts:
    """Contacts in the frame x of those in the frame scale · R x + shift."""
    point_a, point_b = ((points - shift) @ rotation / scale for points in (contacts.point_a, contacts.point_b))
    normal, gap = contacts.normal @ rotation, contacts.gap / scale
    return replace(contacts, point_a=point_a, point_b=point_b, normal=normal, gap=gap)


def _swapped(contacts: Contacts, arrangement: Arrangement) -> Contacts:
    """Contacts among bodies in reverse order, as they are in the order of the arrangement."""
    a, b = arrangement.renumbered(contacts.body_a), arrangement.renumbered(contacts.body_b)
    turned = (a > b)[:, None]
    swapped = Contacts(
        body_a=np.minimum(a, b),
        body_b=np.maximum(a, b),
        point_a=np.where(turned, contacts.point_b, contacts.point_a),
        point_b=np.where(turned, contacts.point_a, contacts.point_b),
        normal=np.where(turned, -contacts.normal, contacts.normal),
        gap=contacts.gap,
        radius_a=np.where(turned[:, 0], contacts.radius_b, contacts.radius_a),
        radius_b=np.where(turned[:, 0], contacts.radius_a, contacts.radius_b),
        at_wall=contacts.at_wall,
    )
    order = np.lexsort((swapped.body_b, swapped.body_a))
    return select(swapped, order)


def _check_empty(contacts: Contacts, dimension: int) -> None:
    for name in (field for field in Contacts.__slots__ if field not in ("shift", "curvatures")):
        wide = name in ("point_a", "point_b", "normal")
        assert getattr(contacts, name).shape == ((0, dimension) if wide else (0,)), name


def _pairs(contacts: Contacts) -> Pairs:
    return list(zip(contacts.body_a.tolist(), contacts.body_b.tolist(), strict=True))
