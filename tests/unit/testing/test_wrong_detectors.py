"""Detectors whose contacts the loop cannot keep, and what the contract says of them."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Contacts, Mesh, Pose
from rigidfluid.detectors.sphere import SphereDetector
from rigidfluid.testing import Arrangement, DetectorContract
from rigidfluid.testing.arrangement import balls_apart


class Reusing(SphereDetector):
    """It writes all gaps into the same array."""

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        found = super().detect(pose, mesh, reach)
        self._gaps: FloatArray = getattr(self, "_gaps", np.zeros(100))
        gap = self._gaps[: len(found)]
        gap[:] = found.gap
        return Contacts(**{each.name: getattr(found, each.name) for each in fields(Contacts)} | {"gap": gap})


class Shrinking(SphereDetector):
    """It does not look farther than half of a short reach."""

    def detect(self, pose: Pose, mesh: Mesh | None, reach: float) -> Contacts:
        return super().detect(pose, mesh, reach if reach > 0.4 else 0.5 * reach)


class Contract(DetectorContract):
    def __init__(self, detector: type[Detector]) -> None:
        self._detector = detector

    def make_detector(self, arrangement: Arrangement) -> Detector:
        return self._detector(PartOptions(), arrangement.bodies, arrangement.walls)


def test_contacts_that_a_later_call_changes_are_told() -> None:
    Contract(SphereDetector).test_contacts_stay_as_they_were_found(balls_apart(2))
    with pytest.raises(AssertionError, match="gap"):
        Contract(Reusing).test_contacts_stay_as_they_were_found(balls_apart(2))


def test_contacts_that_a_shorter_reach_loses_are_told() -> None:
    Contract(SphereDetector).test_a_shorter_reach_leaves_out_what_is_beyond(balls_apart(2))
    with pytest.raises(AssertionError):
        Contract(Shrinking).test_a_shorter_reach_leaves_out_what_is_beyond(balls_apart(2))
