"""Stiff and extreme contacts, each case against its own limits; docs/validation/stability.md has what was found."""

from __future__ import annotations

from pathlib import Path

import pytest
from extreme_cases import CASES, ENDS, Case, Demand, Finding, findings, held_against, surprises, surprises_in
from extreme_scenes import three_disks
from fluid_contacts import created_and_lost
from page_tools.kept_rows import KeptRows
from page_tools.make import make
from page_tools.places import MEASURED

from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import LEDGER_COLUMNS

NAMES = {case.name for case in CASES}


def is_heavy(case: Case) -> bool:
    """Heavy, or a shorter step of a case that is also there with the longest, where most is lost."""
    stem, _, step = case.name.rpartition(", Δt ")
    return case.heavy or (step in ("1 ms", "2 ms") and f"{stem}, Δt 4 ms" in NAMES)


SLOW = {
    *("fluid, stack of two, Δt 4 ms", "fluid, ellipse, tip first, Δt 4 ms", "fluid, spin 1e4, Δt 4 ms"),
    *(f"spin 1e4, semi-axes {axes}" for axes in ("(0.2, 0.1)", "(0.2, 0.01)", "(0.2, 0.15, 0.1)")),
}
"""Those of the others that take a fifth of their time."""

LIGHT = [
    pytest.param(case, id=case.name, marks=pytest.mark.nightly if case.name in SLOW else ())
    for case in CASES
    if not is_heavy(case)
]
GAINED = "energy created"
KNOWN = Demand(GAINED, at_most=0.03)


@pytest.mark.long
@pytest.mark.parametrize("case", LIGHT)
def test_what_is_demanded_holds_but_where_it_is_known_to_fail(case: Case) -> None:
    assert surprises(case, findings(case)) == []


@pytest.mark.validation
@pytest.mark.timeout(0)
def test_so_it_does_in_the_heavy_cases_of_the_page_made_again(tmp_path: Path) -> None:
    """All cases are rows of the page on stability, which are run again where other sources have made them."""
    assert make("stability", present=True, folder=tmp_path, kept=True)
    assert surprises_in(KeptRows.read(MEASURED / "stability.json").rows) == {}


def test_cases_have_names_of_their_own() -> None:
    assert len({case.name for case in CASES}) == len(CASES)


def test_a_mark_of_failure_is_for_what_fails_and_gets_no_worse() -> None:
    marked, unmarked = _case(KNOWN), _case()
    assert _surprises(marked, 0.02) == _surprises(unmarked, 0.005) == []
    assert _surprises(marked, 0.005) == ["energy created: holds now, take it out of what fails"]
    assert _surprises(unmarked, 0.02) == ["energy created at most 0.01; found: 0.02"]
    either_way = _case(Demand(GAINED, at_most=0.03, by_rounding=True))
    assert _surprises(either_way, 0.02) == _surprises(either_way, 0.005) == []
    assert _surprises(marked, 0.04) == ["energy created at most 0.03 is known; found: 0.04"]


def test_a_case_that_stops_is_a_surprise() -> None:
    assert surprises(_case(KNOWN), [Finding(ENDS, ENDS, "stops: too much", False)]) != []


def test_what_viscosity_took_hides_nothing() -> None:
    history = History(2)
    for step, created in enumerate((0.0, 0.0, 0.2)):
        ledger = {"kinetic": 1.0 + created - 0.5 * step, "dissipation": 0.5 * step, "residual": -created}
        history.extend({"energy": [(float(step), step, *(ledger.get(name, 0.0) for name in LEDGER_COLUMNS))]})
    created, lost, _ = created_and_lost(history)
    assert (created, lost) == pytest.approx((0.2, 0.0))


def _case(*fails: Demand) -> Case:
    return Case("three disks", lambda: three_disks({}), (), fails=fails)


def _surprises(case: Case, created: float) -> list[str]:
    return surprises(case, [held_against(case, Demand(GAINED, at_most=0.01), created)])
