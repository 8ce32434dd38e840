"""Seconds of stages."""

from __future__ import annotations

import pytest

from rigidfluid.core.run import stopwatch
from rigidfluid.core.run.stopwatch import Stopwatch


def test_a_stage_within_another_is_counted_once(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 1.0, 4.0, 5.0, 7.0, 10.0])  # outer, inner, inner's end, inner again, its end, outer's end
    monkeypatch.setattr(stopwatch.time, "perf_counter", lambda: next(clock))
    watch = Stopwatch()
    with watch("outer"):
        for _ in range(2):
            with watch("inner"):
                pass
    assert watch.seconds == {"inner": 5.0, "outer": 5.0}


def test_a_stage_that_fails_ends_too(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = iter([0.0, 1.0, 4.0, 10.0])  # outer, inner, inner's end, outer's end
    monkeypatch.setattr(stopwatch.time, "perf_counter", lambda: next(clock))
    watch = Stopwatch()
    with watch("outer"), pytest.raises(ValueError, match="inner"), watch("inner"):
        raise ValueError("inner")
    assert watch.seconds == {"inner": 3.0, "outer": 7.0}
