from rigidfluid.core.interfaces import Detector, PartOptions
from rigidfluid.detectors.brute_force import BruteForceDetector, BruteForceOptions
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.testing import Arrangement, DetectorContract


class TestSphereDetector(DetectorContract):
    gap_tolerance = 1e-14
    point_tolerance = 1e-13

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
