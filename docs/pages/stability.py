"""Stiff and extreme contacts, and what each must do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from extreme_cases import rows
from matplotlib.figure import Figure
from page_tools import Page, Work, table
from page_tools.kept_rows import Row

LEAST, MOST = 1e-5, 10.0
"""Ends of the axis of shares."""


def page(work: Work) -> Page:
    """A dot for each case, those that do not do what is demanded, and all of them."""
    found = work.rows(lambda: rows(processes=2))
    text = ABOUT.format(
        cases=len(found),
        passed=sum(map(passes, found)),
        least=LEAST,
        failing=table(("case", "demanded", "found", "known"), failures(found)),
        table=table(("case", "demanded", "found", "pass"), map(in_full, found)),
    )
    return Page("Stiff and extreme contacts", text, {"": shares(found)})


def passes(row: Row) -> bool:
    """Whether a case does all that is demanded."""
    return all(finding["passed"] for finding in row["findings"])


def failures(found: Sequence[Row]) -> Iterator[tuple[str, str, str, str]]:
    """All findings that are not as demanded, and how far off they are known to be."""
    for row in found:
        for finding in row["findings"]:
            if not finding["passed"]:
                known = [limit for limit in row["fails"] if limit.startswith(finding["figure"])]
                yield row["case"], finding["demanded"], finding["found"], "; ".join(known) or "-"


def in_full(row: Row) -> tuple[str, str, str, str]:
    """A case in the table of all."""
    told = ("; ".join(finding[key] for finding in row["findings"]) for key in ("demanded", "found"))
    failed = ", ".join(["**no**", *filter(None, ["; ".join(row["fails"])])])
    return row["case"], *told, "yes" if passes(row) else failed


def worst_share(row: Row) -> float:
    """Largest share of what is allowed, within the ends of the axis."""
    if any(not finding["passed"] and finding["share"] is None for finding in row["findings"]):
        return MOST
    known = [finding["share"] for finding in row["findings"] if finding["share"] is not None]
    return float(np.clip(max(known, default=LEAST), LEAST, MOST))


def shares(found: Sequence[Row]) -> Figure:
    """The worst share of each case, a strip for each kind, within it in the order of the table."""
    kinds = list(dict.fromkeys(row["kind"] for row in found))
    figure = Figure(figsize=(9.0, 5.0), dpi=100, layout="constrained")
    axes = figure.subplots()
    for number, kind in enumerate(kinds):
        strip = [row for row in found if row["kind"] == kind]
        heights = number + np.linspace(-0.35, 0.35, len(strip))
        for well, style in STYLES.items():
            dots = [(worst_share(row), at) for row, at in zip(strip, heights, strict=True) if passes(row) == well]
            axes.plot(*zip(*dots, strict=True), **style) if dots else None
    names = [f"{kind} ({sum(row['kind'] == kind for row in found)})" for kind in kinds]
    axes.set_yticks(range(len(kinds)), names)
    axes.hlines(np.arange(1, len(kinds)) - 0.5, LEAST, MOST, color="0.9", linewidth=0.8)
    axes.axvline(1.0, color="black", linewidth=0.8)
    axes.set(xscale="log", xlim=(0.7 * LEAST, 1.4 * MOST), xlabel="found, over what is allowed: the worst of each case")
    axes.invert_yaxis()
    return figure


STYLES: dict[bool, dict[str, Any]] = {
    True: {"marker": "o", "linestyle": "", "markersize": 4, "color": "C0", "alpha": 0.7},
    False: {"marker": "X", "linestyle": "", "markersize": 8, "color": "C3"},
}
"""Of cases that pass, and of those that do not."""


ABOUT = """Each dot is a case, at the largest ratio of one of its figures to what is allowed. Cases left of the line
pass: {passed} of {cases}. These do not:

{failing}

Dots at the left edge are at {least:g} or less. Figures of which nothing is allowed, such as overlaps or rejected steps,
have no ratio; a case that fails by one of these alone is at the right edge.

## What is demanded

The scenes and their limits are those of `tests/stability/test_extreme_contacts.py`. Unless the case says otherwise, a
ball has a radius of 0.1 and a density of 1, boxes have a side of 1, and speeds are of order 1.

* smallest gap: the least of the run; above zero there was no overlap at any step.
* rejected steps: none means that the contacts were met by the step as given. Up to ten where films of fluid open,
  which steps are made to follow.
* energy unaccounted for: the largest residual of the balance, of either sign, over the most energy that was stored.
  The residual is what came in, less what went out by viscosity, dampers and re-meshing, less what is stored more than
  at the start.
* energy created by the first step: what the residual was below zero after it, over what was put in. Bodies that start
  in a fluid at rest set it into motion at once.
* energy created, energy lost: how far the residual fell below what it was after the first step, and how far it rose
  above, over what was put in: the energy stored at the start, and the most that gravity, faces and driven bodies had
  worked by any time. Dissipation by viscosity does not hide created energy, but an earlier loss may. The energy
  lost is reduced by `path_friction`, the friction in impacts shorter than a step, which the balance does not contain.
  The energy created is not reduced.
* energy lost untold: that of a run that names no body that turned too far in a step. A disk that spins at 1e4 rad/s
  turns by 10 rad in a millisecond: [why energy is lost by that](../numerics.md#flow-that-goes-round-with-a-body), and
  how it falls with the step.

In a fluid at most 1 % may be created, with any step; and at most 30, 15, 7 and 4 % be lost
with steps of 4, 2, 1 and .5 ms. A case that does not do what is demanded of it stays in the table, and says **no**.

## All cases

<details> <summary>{cases} cases: demanded and found</summary>

{table}

</details>"""
