"""Strokes and drives that take no longer than a step are refused: a step would not meet what they do."""

import pytest
from scenes import dry_tables

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.errors import SceneError

ROWS = [[0.0, 0.0], [0.05, 0.1], [0.1, 0.0]]
BALL = {"type": "sphere", "radius": 0.1, "density": 1.0}


def built(step, stroke=None, drive=None, **time):
    """A mechanism of two balls, the right one moved by a ``stroke``; or a ball on a hinge with a ``drive``."""
    parts = [BALL | {"name": name, "position": [x, 0.0]} for name, x in (("left", 0.0), ("right", 0.5))]
    moved = {"moves": ["right"], "along": [1.0, 0.0]} | (stroke or {})
    mechanism = {"name": "it", "type": "articulated", "component": parts, "stroke": [moved], "position": [1.0, 1.0]}
    arm = {"name": "arm", "position": [0.5, 0.5]} | BALL
    joint = {"name": "pin", "type": "hinge", "between": ["arm"], "at": [0.7, 0.5], "drive": drive}
    return build_system(
        scene_from_dict(
            dry_tables(
                *([arm] if drive else []),
                step=step,
                time=time,
                domain={"lower": [0.0, 0.0], "upper": [2.0, 2.0]},
                joint=[joint] if drive else [],
                mechanism=[mechanism] if stroke else [],
            )
        )
    )


@pytest.mark.parametrize(("what", "name"), [("stroke", "mechanism 'it'"), ("drive", "drive of joint 'pin'")])
def test_a_step_that_meets_only_ends_of_a_smooth_stroke_is_refused(what, name):
    with pytest.raises(SceneError, match=rf"time.step: found 0.1, in which .*{name}.*at most 0.033"):
        built(0.1, **{what: {"smooth": ROWS}})
    assert built(0.03, **{what: {"smooth": ROWS}})


@pytest.mark.parametrize("what", ["stroke", "drive"])
def test_corners_nearer_to_each_other_than_the_shortest_step_are_refused(what):
    rows = [[0.0, 0.0], [5e-5, 0.1], [1.0, 0.0]]
    with pytest.raises(SceneError, match=r"time.shortest: found 9.76.*e-05.*at most 5e-05"):
        built(0.1, **{what: {"piecewise": rows}})
    assert built(0.1, shortest=4e-5, **{what: {"piecewise": rows}})


def test_steps_end_at_corners_so_that_they_may_be_longer_than_a_period():
    assert built(0.2, {"piecewise": ROWS})


def test_what_turns_to_and_fro_many_times_in_a_period_is_seen():
    """As often as there are samples, or half as often: all of them in one phase would show no motion."""
    rows = [[number / 64, 0.1 * (number % 2)] for number in range(65)]
    with pytest.raises(SceneError, match=r"time.step: found 0.02"):
        built(0.02, {"smooth": rows})


def test_a_step_that_meets_only_ends_of_a_prescribed_sine_is_refused():
    data = dry_tables(
        BALL | {"name": "it", "position": [1.0, 1.0], "prescribed": {"amplitude": [0.5, 0.0], "frequency": 50.0}},
        step=0.02,
        domain={"lower": [0.0, 0.0], "upper": [2.0, 2.0]},
    )
    with pytest.raises(SceneError, match=r"time.step: found 0.02, 1 periods of body 'it'; allowed is at most 0.00637"):
        scene_from_dict(data)
    assert scene_from_dict(data | {"time": {"end": 1.0, "step": 0.006}})
