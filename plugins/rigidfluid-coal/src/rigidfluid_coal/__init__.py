"""A detector for convex bodies, by the collision library coal."""

from __future__ import annotations

from rigidfluid.api import Detector, hookimpl
from rigidfluid_coal.detector import CoalDetector


@hookimpl
def rigidfluid_detectors() -> list[type[Detector]]:
    """The detector "coal"."""
    return [CoalDetector]
