"""Strokes: lengths and angles as functions of time."""

import numpy as np
import pytest

from rigidfluid.core.mechanics.strokes import Stroke
from rigidfluid.core.nested.strokes import build_stroke
from rigidfluid.core.scene.rows_over_time import StrokeTable
from rigidfluid.core.scene.validation import read_table
from rigidfluid.errors import SceneError

SQUARE = ((0.0, 0.0), (1.0, -4.0), (2.0, -4.0), (3.0, 0.0))
TURNED = ((0.0, 1.0), (0.5, 2.0), (1.5, 5.0))


def test_a_piecewise_stroke_is_linear_between_its_rows_and_repeats():
    stroke = Stroke(SQUARE, period=4.0)
    values = [stroke.value(time) for time in (0.0, 0.25, 1.0, 1.7, 2.5, 3.0, 3.9, 4.0, 8.25, -3.75)]
    np.testing.assert_allclose(values, [0.0, -1.0, -4.0, -4.0, -2.0, 0.0, 0.0, 0.0, -1.0, -1.0], atol=1e-14)


def test_at_a_corner_the_rate_is_that_of_the_step_that_ends_there():
    stroke = Stroke(SQUARE, period=4.0)
    found = [stroke.rate(time) for time in (0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 4.1, 8.0, 9.0)]
    np.testing.assert_allclose(found, [-4.0, -4.0, -4.0, 0.0, 0.0, 4.0, 0.0, -4.0, 0.0, -4.0])


@pytest.mark.parametrize("step", [0.1, 0.3, 1.0 / 7.0])
def test_times_that_are_rounded_still_meet_their_corners(step):
    stroke = Stroke([(0.0, 0.0), (step, 1.0), (2.0 * step, 0.0)], period=2.0 * step)
    for number in range(1, 400):
        expected = (1.0 if number % 2 else -1.0) / step
        assert stroke.rate(step * number) == pytest.approx(expected)
        assert stroke.next_corner(step * number) == pytest.approx(step * (number + 1))


def test_corners_are_where_the_rate_jumps():
    stroke = Stroke(SQUARE, period=4.0)
    times = [0.0]
    while len(times) < 8:
        times.append(stroke.next_corner(times[-1]))
    np.testing.assert_allclose(times, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
    straight = Stroke([(0.0, 0.0), (1.0, 1.0), (3.0, 3.0), (6.0, 0.0)], period=6.0)
    assert straight.next_corner(0.0) == 3.0
    once = Stroke([(0.0, 0.0), (1.0, 1.0)])
    assert [once.next_corner(0.0), once.next_corner(1.0)] == [1.0, np.inf]
    assert Stroke(SQUARE, smooth=True, period=4.0).next_corner(0.0) == np.inf


def test_a_stroke_that_is_not_repeated_holds_its_last_value():
    for smooth in (False, True):
        stroke = Stroke(TURNED, smooth)
        assert stroke.value(9.0) == 5.0
        assert stroke.rate(9.0) == 0.0


@pytest.mark.parametrize("rows", [SQUARE, ((0.0, 0.0), (0.3, 1.0), (0.8, 1.5), (1.0, 3.0), (2.0, 0.0))])
def test_a_smooth_stroke_meets_its_rows_overshoots_none_and_has_a_continuous_rate(rows):
    period = rows[-1][0]
    stroke, times = Stroke(rows, smooth=True, period=period), np.linspace(0.0, 2.0 * period, 4001)
    values, rates = (np.array([function(time) for time in times]) for function in (stroke.value, stroke.rate))
    for time, value in rows:
        assert stroke.value(time) == pytest.approx(value, abs=1e-13)
    lowest, highest = np.min(rows, axis=0)[1], np.max(rows, axis=0)[1]
    assert values.min() >= lowest - 1e-12
    assert values.max() <= highest + 1e-12
    assert np.abs(np.diff(rates)).max() < 0.03 * np.abs(rates).max()
    np.testing.assert_allclose(np.gradient(values, times)[1:-1], rates[1:-1], atol=0.01 * np.abs(rates).max())
    turning = [time for time, value in rows if value in (lowest, highest)]
    np.testing.assert_allclose([stroke.rate(time) for time in turning], 0.0, atol=1e-12)


def test_a_smooth_stroke_need_not_stop_on_its_way():
    assert Stroke([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (4.0, 0.0)], smooth=True, period=4.0).rate(1.0) > 0.5


def stroke(**keys):
    return build_stroke(read_table(StrokeTable, keys, "it"), "it")


def test_a_period_is_that_of_the_rows_if_none_is_given(tmp_path):
    assert stroke(piecewise=SQUARE).period == 3.0
    assert stroke(smooth=SQUARE, period=5.0).period == 5.0
    assert stroke(piecewise=TURNED, repeat=False).period is None
    path = tmp_path / "rows.csv"
    path.write_text("# time, value\n0.0, 0.0\n1.0, 2.0\n2.0, 0.0\n", encoding="utf-8")
    assert stroke(piecewise={"file": str(path)}).value(0.5) == 1.0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({}, "it: found neither piecewise nor smooth"),
        ({"piecewise": SQUARE, "smooth": SQUARE}, "it: found both"),
        ({"piecewise": []}, r"it.piecewise: found 0 rows"),
        ({"smooth": [[0.0, 1.0]]}, r"it.smooth: found 1 rows"),
        ({"piecewise": [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0]]}, r"it.piecewise.2: found time 1 after 1"),
        ({"piecewise": [[0.5, 0.0], [1.0, 0.0]]}, r"it.piecewise.0: found time 0.5; allowed is time 0"),
        ({"piecewise": [[-0.5, 0.0], [1.0, 0.0]]}, r"it.piecewise.0: found time -0.5"),
        ({"piecewise": TURNED}, r"it.piecewise.2: found value 5 at the period's end, a jump back to 1"),
        ({"piecewise": SQUARE, "period": 2.0}, r"it.period: found 2.0.*at least 3"),
        ({"piecewise": TURNED, "period": 2.0, "repeat": False}, r"it.period.*none with repeat = false"),
        ({"piecewise": {"file": "/nowhere.csv"}}, r"it.piecewise.file.*nowhere.csv: No such file"),
    ],
)
def test_strokes_that_cannot_be_are_refused(keys, message):
    with pytest.raises(SceneError, match=message):
        stroke(**keys)
