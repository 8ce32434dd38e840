"""A run that lost energy by bodies that spin too far in a step says which step would do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from extreme_wet import floor_hit

import rigidfluid
from rigidfluid.core.output.history import History
from rigidfluid.core.run.turn_remarks import ADVISED_TOLERANCE

pytestmark = pytest.mark.long

SPIN = 1e4


def spun(step: float, **time: float) -> History:
    """A disk that spins and crosses the box, until a little after it has hit the floor."""
    tables = floor_hit(step, "substeps", velocity=[0.0, -80.0], angular_velocity=[SPIN]).to_dict()
    tables |= {"time": {"end": 0.006, "step": step} | time, "output": {"every": 0.006}}
    return rigidfluid.run(rigidfluid.scene_from_dict(tables))


def remarks(history: History) -> list[dict[str, Any]]:
    return [remark for remark in history.summary["remarks"] if "rad in a step" in remark["text"]]


def test_halving_a_step_of_many_radians_does_not_help_and_the_step_that_is_named_does() -> None:
    long, half = spun(1e-3), spun(5e-4)
    assert long.summary["energy"]["lost"] > 0.02
    assert half.summary["energy"]["lost"] > 0.5 * long.summary["energy"]["lost"]
    (remark,) = remarks(long)
    assert remark["grade"] == "warning"
    assert "'body0' turned by up to" in remark["text"]
    named = float(remark["remedy"].removeprefix("Set time.step to ").split()[0])
    assert 0.4 < SPIN * named < 0.6
    short = spun(named)
    assert short.summary["energy"]["lost"] < 0.005
    assert remarks(short) == []


def test_steps_by_the_tolerance_that_is_named_keep_the_energy() -> None:
    (remark,) = remarks(spun(1e-3))
    assert remark["remedy"].endswith(f"or time.tolerance to {ADVISED_TOLERANCE:g}.")
    by_tolerance = spun(1e-3, tolerance=ADVISED_TOLERANCE)
    assert by_tolerance.summary["energy"]["lost"] < 0.005
    assert remarks(by_tolerance) == []


def test_steps_of_less_than_a_radian_lose_a_quarter_or_less_with_half_the_step() -> None:
    lost = np.array([spun(step).summary["energy"]["lost"] for step in (6.25e-5, 3.125e-5, 1.5625e-5)])
    assert lost[0] > 1e-4
    assert np.all(lost[1:] < 0.25 * lost[:-1])
