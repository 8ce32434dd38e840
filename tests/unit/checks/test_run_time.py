"""Estimates of a run's time in words."""

from __future__ import annotations

import pytest

from rigidfluid.checks.run_time import time_in_words


@pytest.mark.parametrize(
    ("least", "most", "words"),
    [(0.234, 2.61, "0.23 to 2.6 s"), (12.3, 104.0, "12 to 100 s"), (12.6, 1040.0, "0.21 to 17 min")],
)
def test_no_estimate_has_an_exponent(least: float, most: float, words: str) -> None:
    assert time_in_words(least, most) == words
