"""Values over time that actions set."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid_gymnasium import Course


@pytest.fixture
def course() -> Course:
    """From 1 to 3 between times 0.5 and 1, and after a rest to -1 between 1.5 and 2."""
    made = Course(np.array([1.0]))
    made.turn(0.5, np.array([3.0]), 0.5)
    made.turn(1.5, np.array([-1.0]), 0.5)
    return made


@pytest.mark.parametrize(
    ("time", "value"), [(0.0, 1.0), (0.5, 1.0), (0.75, 2.0), (1.0, 3.0), (1.3, 3.0), (2.0, -1.0), (9.0, -1.0)]
)
def test_values_rest_turn_and_arrive(course: Course, time: float, value: float) -> None:
    assert course.value(time) == pytest.approx(value)


def test_the_rate_is_that_of_the_value(course: Course) -> None:
    times = np.array([0.1, 0.55, 0.7, 0.8, 1.2, 1.6, 1.75, 2.1])
    slopes = [(course.value(time + 1e-6) - course.value(time - 1e-6)) / 2e-6 for time in times]
    np.testing.assert_allclose([course.rate(time) for time in times], slopes, rtol=1e-6, atol=1e-8)
    assert np.abs(slopes).max() > 11.0
