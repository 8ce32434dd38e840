"""The page of extreme contacts: what fails comes first, and each case has its place in the picture."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import pytest
from extreme_cases import CASES, KIND, Demand, Finding, surprises_in
from page_tools.kept_rows import KeptRows
from page_tools.places import MEASURED
from pages.stability import LEAST, MOST, failures, in_full, passes, shares, worst_share

LOST = Finding("energy lost", "energy lost at most 0.07", "0.14", False, share=2.0)
KEPT = Finding("energy created", "energy created at most 0.01", "0.001", True, share=0.1)
REJECTED = Finding("rejected steps", "rejected steps at most 0", "3", False)
APART = Finding("smallest gap over the radius", "smallest gap over the radius above 0", "0.4", True)


def row(*found: Finding, fails: tuple[str, ...] = ()) -> dict[str, Any]:
    return {"kind": "fluid", "case": "a disk", "findings": list(map(asdict, found)), "fails": fails}


def test_what_is_marked_as_a_failure_fails_in_the_measured_rows_and_nothing_else_does() -> None:
    assert surprises_in(KeptRows.read(MEASURED / "stability.json").rows) == {}


def test_what_fails_is_told_with_what_is_known_of_that_figure() -> None:
    found = [row(APART, KEPT), row(LOST, REJECTED, fails=("energy lost at most 0.3",))]
    assert list(failures(found)) == [
        ("a disk", "energy lost at most 0.07", "0.14", "energy lost at most 0.3"),
        ("a disk", "rejected steps at most 0", "3", "-"),
    ]
    assert list(map(passes, found)) == [True, False]


def test_the_table_of_all_says_what_is_no_pass() -> None:
    assert in_full(row(APART, KEPT))[-1] == "yes"
    assert in_full(row(KEPT, LOST)) == (
        "a disk", "energy created at most 0.01; energy lost at most 0.07", "0.001; 0.14", "**no**",
    )  # fmt: skip
    assert in_full(row(LOST, fails=("energy lost at most 0.3",)))[-1] == "**no**, energy lost at most 0.3"


def test_a_dot_is_the_worst_share() -> None:
    assert worst_share(row(APART, KEPT, LOST)) == 2.0
    assert worst_share(row(APART)) == LEAST
    assert worst_share(row(KEPT, REJECTED)) == MOST


def test_each_case_is_a_dot_of_one_kind() -> None:
    figure = shares([row(APART, KEPT), row(LOST), row(REJECTED)])
    dots = [len(line.get_xdata()) for line in figure.axes[0].get_lines()]
    assert dots == [1, 2, 2]  # passed, failed, and the line of what is allowed
    assert set(KIND) == {case.name for case in CASES}


@pytest.mark.parametrize(
    ("demand", "value", "share"),
    [
        (Demand("energy lost", at_most=0.2), 0.05, 0.25),
        (Demand("force of the floor over the weight", 0.98, 1.02), 1.01, 0.5),
        (Demand("smallest gap over the radius", above=0.0), 0.3, None),
        (Demand("rejected steps", at_most=0.0), 3.0, None),
    ],
)
def test_a_share_is_of_what_is_allowed(demand: Demand, value: float, share: float | None) -> None:
    assert demand.share(value) == (None if share is None else pytest.approx(share, rel=1e-2))
