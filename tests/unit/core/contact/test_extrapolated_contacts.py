"""Contacts that move with their bodies, against a new detection."""

import numpy as np
import pytest
from mesh_tools import ball, ellipsoid

from rigidfluid.core.contact.pairs.extrapolated_contacts import ExtrapolatedContacts
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import rotate
from rigidfluid.core.model.part import PartOptions
from rigidfluid.core.model.types import Pose
from rigidfluid.detectors.ellipsoid import EllipsoidDetector
from rigidfluid.detectors.sphere import SphereDetector

FLOOR = Wall(2, "bottom", Plane(np.array([0.0, 0.0]), np.array([0.0, 1.0])))
START = Pose(np.array([[0.3, 0.2], [0.55, 0.25]]), np.array([[0.3], [-0.8]]))


def later(time):
    shift, turn = np.array([[0.02, -0.01], [-0.03, 0.04]]), np.array([[0.4], [-0.3]])
    return Pose(START.position + time * shift, rotate(START.orientation, time * turn))


def test_balls_are_followed_exactly():
    detector = SphereDetector(PartOptions(), [ball(0.1), ball(0.12)], [FLOOR])
    followed = ExtrapolatedContacts(detector.detect(START, None, np.inf), START).extrapolate(later(1.0))
    found = detector.detect(later(1.0), None, np.inf)
    for name in ("body_a", "body_b", "gap", "normal", "point_a", "point_b"):
        np.testing.assert_allclose(getattr(followed, name), getattr(found, name), atol=1e-14, err_msg=name)


@pytest.mark.parametrize("contact", [0, 1, 2])
def test_other_shapes_to_first_order(contact):
    detector = EllipsoidDetector(PartOptions(), [ellipsoid(0.14, 0.07), ellipsoid(0.12, 0.08)], [FLOOR])
    follow = ExtrapolatedContacts(detector.detect(START, None, np.inf), START)
    errors = [
        abs(follow.extrapolate(later(time)).gap[contact] - detector.detect(later(time), None, np.inf).gap[contact])
        for time in (0.4, 0.2, 0.1)
    ]
    moved = abs(detector.detect(later(0.1), None, np.inf).gap - detector.detect(START, None, np.inf).gap)[contact]
    assert errors[2] < 0.2 * moved
    assert np.log2(errors[0] / errors[1]) > 1.7
    assert np.log2(errors[1] / errors[2]) > 1.8
