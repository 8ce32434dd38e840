"""Stiff and extreme contacts, and what each must do."""

from __future__ import annotations

from extreme_cases import rows
from page_tools import Page, Work, table


def page(work: Work) -> Page:
    """All cases, and how many do not do what is demanded."""
    found = list(rows(processes=2))
    passed = sum("no" not in row[-1] for row in found)
    text = ABOUT.format(cases=len(found), passed=passed, table=table(("case", "demanded", "found", "pass"), found))
    return Page("Stiff and extreme contacts", text)


ABOUT = """The scenes and their limits are those of `tests/stability/test_extreme_contacts.py`. Unless the case says
otherwise, a ball has a radius of 0.1 and a density of 1, boxes have a side of 1, and speeds are of order 1.

* smallest gap: the least of the run; above zero there was no overlap at any step.
* rejected steps: none means that the contacts were met by the step as given. Up to ten where films of fluid open, which
  steps are made to follow.
* energy unaccounted for: the largest residual of the balance, of either sign, over the most energy that was stored.
  The residual is what came in, less what went out by viscosity, dampers and re-meshing, less what is stored more than
  at the start.
* energy created by the first step: what the residual was below zero after it, over what was put in. Bodies that start
  in a fluid at rest set it into motion at once.
* energy created, energy lost: how far the residual fell below what it was after the first step, and how far it rose
  above, over what was put in: the energy stored at the start, and the most that gravity, faces and driven bodies had
  worked by any time. What viscosity took hides nothing of what was created, but what was lost
  before may. Of what was lost, `path_friction` is taken off: friction in impacts shorter than a step, which
  the balance does not see. It excuses no energy that was created.
* energy lost untold: that of a run that names no body that turned too far in a step. A disk that spins at 1e4
  rad/s turns by 10 rad in a millisecond:
  [why energy is lost by that](../numerics.md#flow-that-goes-round-with-a-body), and how it falls with the step.

In a fluid at most 3 % may be created, with steps of a millisecond and below 1 %; and at most 30, 15, 7 and 4 % be lost
with steps of 4, 2, 1 and .5 ms. A case that does not do what is demanded of it stays in the table, and says **no**.
{passed} of {cases} cases pass.

{table}"""
