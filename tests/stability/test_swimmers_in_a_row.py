"""A swimmer between two others: contacts of mechanisms with mechanisms, which strokes press together."""

import numpy as np
import pytest
from falling import SCENES
from fluid_contact_table import track

import rigidfluid

pytestmark = pytest.mark.long


def test_three_swimmers_meet_and_never_overlap():
    """The outer two swim towards the middle one; as arms lengthen at the end of a cycle, their balls press on it."""
    coarse = ["time.end=4.25", "mesh.size=8.0", "mesh.size_body=0.8"]
    history = rigidfluid.run(rigidfluid.load_scene(SCENES / "three_swimmers.toml", coarse))
    force = track(history, "cfx")[:, :9]
    behind, left, right, ahead = force[:, 2], force[:, 3], force[:, 5], force[:, 6]
    assert behind.min() < -0.5
    assert ahead.max() > 0.5
    np.testing.assert_allclose(left, -behind, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(right, -ahead, rtol=1e-12, atol=1e-12)
    assert history.bodies["gap"].min() > 0.1
    assert abs(history.summary["energy"]["created"]) < 0.01
    middle = track(history, "y")[:, 10]
    assert middle == pytest.approx(10.0, abs=0.1)
