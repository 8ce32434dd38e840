"""The contact detectors that come with rigidfluid."""

from __future__ import annotations

from rigidfluid.core.model.detector import Detector
from rigidfluid.detectors.brute_force import BruteForceDetector
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.facets import FacetDetector
from rigidfluid.detectors.fast_marching import FastMarchingDetector
from rigidfluid.detectors.narrow_band import NarrowBandDetector
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.hookspecs import hookimpl


@hookimpl
def rigidfluid_detectors() -> list[type[Detector]]:
    """The built-in detectors."""
    return [
        SphereDetector,
        EllipsoidDetector,
        FacetDetector,
        NarrowBandDetector,
        FastMarchingDetector,
        BruteForceDetector,
    ]
