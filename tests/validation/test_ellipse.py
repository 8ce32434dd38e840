"""An ellipse that is released at 45° in a channel, against the published path and angle."""

from pathlib import Path

import numpy as np
import pytest
from published import ELLIPSE_ANGLE, ELLIPSE_PATH, ELLIPSE_TERMINAL_SPEED

import rigidfluid

SCENE = Path(__file__).parents[2] / "scenes" / "ellipse_xia.toml"
LONG_AXIS = 0.1
pytestmark = pytest.mark.validation


@pytest.fixture(scope="module")
def bodies():
    coarse = ["mesh.size_body=0.006", "mesh.size=0.06", "time.step=0.004"]
    return rigidfluid.run(rigidfluid.load_scene(SCENE, coarse)).bodies


def off(bodies, values, curve):
    """Differences from the points of a curve over height; it sinks all the time."""
    points = curve[LONG_AXIS * curve[:, 0] >= bodies["y"].min()]
    return np.interp(-LONG_AXIS * points[:, 0], -bodies["y"], values) - points[:, 1]


def root_mean_square(values):
    return np.sqrt(np.mean(values**2))


def test_it_glides_to_one_side_and_back_as_published(bodies):
    assert root_mean_square(off(bodies, bodies["x"] / LONG_AXIS, ELLIPSE_PATH)) < 0.02
    assert bodies["x"].min() / LONG_AXIS == pytest.approx(ELLIPSE_PATH[:, 1].min(), abs=0.03)


def test_it_turns_as_published_and_sinks_broadside(bodies):
    assert root_mean_square(off(bodies, bodies["angle"] / np.pi, ELLIPSE_ANGLE)) < 0.02
    assert abs(bodies["angle"][-1]) < 0.02 * np.pi


def test_it_sinks_as_fast_as_the_published_points_tell_to_their_reading_error(bodies):
    steady = (bodies["y"] > 0.6) & (bodies["y"] < 1.4)
    assert -bodies["vy"][steady].mean() == pytest.approx(ELLIPSE_TERMINAL_SPEED, rel=0.01)
