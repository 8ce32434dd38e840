"""The attack by parts that lie: which lies hold."""

from __future__ import annotations

import pytest
from attacks import parts
from attacks.parts import attack_by_parts


def test_the_seed_draws_the_lies_and_errors_name_them() -> None:
    drawn = list(attack_by_parts(3, 1))
    assert [trial.how for trial in drawn if trial.held] == ["refused"] * 3
    assert list(attack_by_parts(3, 1)) == drawn


def test_a_lie_that_nobody_notices_does_not_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "ways", lambda lie: {"run": lambda: None})
    assert [(trial.how, trial.held) for trial in attack_by_parts(1, 1)] == [("finished", False)]
