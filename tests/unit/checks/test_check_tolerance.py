"""What `check` says of a tolerance of a step's error."""

from __future__ import annotations

import pytest
from falling import falling_disk

from rigidfluid.checks import Finding, check


def findings(**time: float) -> list[Finding]:
    return [one for one in check(falling_disk(time=time)).findings if one.question == "tolerance"]


def test_without_a_tolerance_nothing_is_asked() -> None:
    assert findings() == []


@pytest.mark.parametrize(("shortest", "grade", "halvings"), [(0.001 / 64, "note", 6), (0.001 / 63, "warning", 5)])
def test_the_first_step_takes_six_halvings(shortest: float, grade: str, halvings: int) -> None:
    (finding,) = findings(tolerance=1e-3, shortest=shortest)
    assert (finding.grade, finding.found["halvings"]) == (grade, halvings)
    assert finding.enough == ({} if grade == "note" else {"shortest": 0.001 / 64})
