"""Stiff and extreme contacts, each case against its own limits; docs/validation/stability.md has what was found."""

from __future__ import annotations

import pytest
from extreme_cases import CASES, Case, findings

LIGHT_AND_HEAVY = [
    pytest.param(case, id=case.name, marks=[pytest.mark.validation] if case.heavy else []) for case in CASES
]


@pytest.mark.parametrize("case", LIGHT_AND_HEAVY)
def test_what_is_demanded_holds(case: Case) -> None:
    assert [finding for finding in findings(case) if not finding.passed] == []


def test_cases_have_names_of_their_own() -> None:
    assert len({case.name for case in CASES}) == len(CASES)
