from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.facets import FacetDetector
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector, NarrowBandOptions
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.testing import Arrangement, DetectorContract
from rigidfluid.testing.arrangement import ball_pair, balls_apart, random_ellipsoids


class TestSphereDetector(DetectorContract):
    gap_tolerance = 1e-14
    point_tolerance = 1e-13
    balls_only = True

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return SphereDetector(PartOptions(), arrangement.bodies, arrangement.walls)


class TestBruteForceDetector(DetectorContract):
    gap_tolerance = 1e-12

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return BruteForceDetector(BruteForceOptions(samples=200), arrangement.bodies, arrangement.walls)


class TestEllipsoidDetector(DetectorContract):
    gap_tolerance = 1e-14
    point_tolerance = 1e-13

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return EllipsoidDetector(PartOptions(), arrangement.bodies, arrangement.walls)


class TestFacetDetector(DetectorContract):
    gap_tolerance = 1e-14
    point_tolerance = 1e-13

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return FacetDetector(PartOptions(), arrangement.bodies, arrangement.walls)


class TestNarrowBandDetector(DetectorContract):
    gap_tolerance = 1e-12
    detects_overlap = False

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return NarrowBandDetector(NarrowBandOptions(), arrangement.bodies, arrangement.walls)


class TestFirstOrderNarrowBand(DetectorContract):
    gap_tolerance = 1e-12
    detects_overlap = False

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return NarrowBandDetector(NarrowBandOptions(accuracy="first-order"), arrangement.bodies, arrangement.walls)


class TestFastMarchingDetector(DetectorContract):
    gap_tolerance = 1e-12
    detects_overlap = False

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return FastMarchingDetector(FastMarchingDetector.Options(), arrangement.bodies, arrangement.walls)


def test_facets_of_a_circle_and_a_sphere_are_as_deep_as_theory_says():
    for dimension, share in ((2, 1 / 8), (3, 1 / 6)):
        pair = ball_pair(dimension)
        for body, radius in enumerate(pair.semi_axes[:, 0]):
            corners = pair.mesh.points[pair.mesh.facets[pair.mesh.markers == body]]
            edges = np.linalg.norm(corners[:, 1:] - corners[:, :1], axis=2)
            edges = np.append(edges, np.linalg.norm(corners[:, -1] - corners[:, -2], axis=1))
            bound = share * edges.max() ** 2 / radius
            assert 0.75 * bound < pair.depths[body] <= 1.01 * bound


Fault = Callable[[Contacts], Contacts]


def flipped(contacts: Contacts) -> Contacts:
    return replace(contacts, normal=-contacts.normal)


def dropped(contacts: Contacts) -> Contacts:
    return select(contacts, np.arange(1, len(contacts)))


def enlarged(contacts: Contacts) -> Contacts:
    return replace(contacts, gap=1.01 * contacts.gap)


def unsorted(contacts: Contacts) -> Contacts:
    return select(contacts, np.arange(len(contacts))[::-1])


def off_the_surface(contacts: Contacts) -> Contacts:
    away = 0.01 * contacts.normal
    return replace(contacts, point_a=contacts.point_a + away, point_b=contacts.point_b + away)


def with_lengths(contacts: Contacts) -> Contacts:
    return replace(contacts, gap=contacts.gap + 1e-6)


def exchanged(contacts: Contacts) -> Contacts:
    return replace(contacts, point_a=contacts.point_b, point_b=contacts.point_a, normal=-contacts.normal)


def doubled(contacts: Contacts) -> Contacts:
    return select(contacts, np.repeat(np.arange(len(contacts)), 2))


def flat(contacts: Contacts) -> Contacts:
    return contacts if len(contacts) else replace(contacts, normal=np.zeros(0))


BALLS, ELLIPSOIDS = balls_apart(2), random_ellipsoids(2, 0)


@pytest.mark.parametrize(
    ("fault", "test", "subject"),
    [
        (flipped, "test_points_are_on_the_surfaces_and_a_gap_apart", ELLIPSOIDS),
        (flipped, "test_normal_points_from_b_to_a", 2),
        (exchanged, "test_points_are_on_the_surfaces_and_a_gap_apart", ELLIPSOIDS),
        (dropped, "test_gaps_of_ellipsoids_are_those_of_brute_force", ELLIPSOIDS),
        (dropped, "test_gaps_of_balls_and_walls", 2),
        (enlarged, "test_gaps_of_balls_and_walls", 3),
        (enlarged, "test_points_are_on_the_surfaces_and_a_gap_apart", ELLIPSOIDS),
        (unsorted, "test_contacts_are_sorted_and_within_reach", ELLIPSOIDS),
        (unsorted, "test_gaps_of_balls_and_walls", 2),
        (doubled, "test_gaps_of_balls_and_walls", 2),
        (off_the_surface, "test_points_are_on_the_surfaces_and_a_gap_apart", ELLIPSOIDS),
        (with_lengths, "test_scales_with_the_lengths", BALLS),
        (flat, "test_nothing_near", 2),
        (flat, "test_nothing_beyond_reach", 3),
    ],
)
@pytest.mark.parametrize("contract", [TestBruteForceDetector, TestNarrowBandDetector])
def test_the_contract_refuses(
    contract: type[DetectorContract], fault: Fault, test: str, subject: int | Arrangement
) -> None:
    class Faulty(contract):  # type: ignore[valid-type, misc]
        def detect(self, arrangement: Arrangement, reach: float) -> Contacts:
            return fault(super().detect(arrangement, reach))

    getattr(contract(), test)(subject)
    with pytest.raises(AssertionError):
        getattr(Faulty(), test)(subject)
