"""Estimates of a run's time in words."""

from __future__ import annotations

import pytest
from scenes import dry_tables

from rigidfluid.api import scene_from_dict
from rigidfluid.checks import run_time
from rigidfluid.checks.run_time import dry_run_time_findings, time_in_words
from rigidfluid.core.case.system import build_system


@pytest.mark.parametrize(
    ("least", "most", "words"),
    [(0.234, 2.61, "0.23 to 2.6 s"), (12.3, 104.0, "12 to 100 s"), (12.6, 1040.0, "0.21 to 17 min")],
)
def test_no_estimate_has_an_exponent(least: float, most: float, words: str) -> None:
    assert time_in_words(least, most) == words


def test_implicit_steps_without_a_fluid_take_longer_than_substeps_of_a_few_balls(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two balls with friction took 35 ms a step, far more than substeps of them."""
    monkeypatch.setattr(run_time, "machine_speed", lambda: 1.0)
    ball = {"type": "sphere", "radius": 0.1, "density": 1.0, "position": [0.5, 0.5, 0.5]}

    def most(stepping: str) -> float:
        contact = {"law": "centre", "range": 0.02, "epsilon": 1e-4, "stepping": stepping}
        scene = scene_from_dict(dry_tables(ball, contact=contact, end=1.0, step=0.01))
        (finding,) = dry_run_time_findings(build_system(scene), scene.time)
        return float(finding.found["most"])  # type: ignore[arg-type]

    assert most("substeps") < 100 * 0.003
    assert most("implicit") > 100 * 0.035
