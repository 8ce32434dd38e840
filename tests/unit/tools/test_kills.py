"""A run that is killed whenever it is, and taken up again, comes to the results of an unbroken one to the last bit.

`python tools/attack.py kills` does the same a hundred times, in a fluid too.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from attacks.kills import SIGNALS, Kill, attack_by_kills
from attacks.small_runs import differences

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals there")


@pytest.mark.long
def test_a_killed_run_comes_to_the_same_results() -> None:
    trials = list(attack_by_kills(4, start=28))
    # On a machine whose speed varies, some runs end before their signal; others are started for them.
    assert sum(trial.how != "ended first" for trial in trials) == 4
    assert [trial for trial in trials if not trial.held] == []


def test_other_results_are_seen(tmp_path: Path) -> None:
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "bodies.csv").write_text("time\n0.1\n")
    assert differences(tmp_path / "one", tmp_path / "other") == []
    (tmp_path / "other" / "bodies.csv").write_text("time\n0.10000000000000002\n")
    assert differences(tmp_path / "one", tmp_path / "other") == ["bodies.csv"]


@pytest.mark.parametrize("number", SIGNALS)
def test_a_traceback_or_another_exit_code_is_no_orderly_end(number: int) -> None:
    assert Kill(number, 0.1, -number, "").orderly
    assert not Kill(number, 0.1, 1, "").orderly
    assert not Kill(number, 0.1, -number, "Traceback (most recent call last): rigidfluid/cli/…").orderly
