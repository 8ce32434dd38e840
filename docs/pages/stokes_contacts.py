"""Contacts in a fluid without inertia: rest, speeds and energy over the step."""

from __future__ import annotations

from page_tools import Page, Work, table
from page_tools.settings import settings_of
from stokes_contacts import cases, rows

HEAD = (
    *("case", "stepping", "step [s]", "force / weight", "speed, late [cm/s]", "gap, less exact [cm]"),
    *("created [%]", "lost [%]", "steps", "CPU [s]"),
)


def page(work: Work) -> Page:
    """A row for each case, stepping and step."""
    for name, scene, _, (step, *_) in cases():
        work.watch(name, settings_of(scene(step, "substeps")))
    return Page("Contacts in Stokes flow", ABOUT.format(rows=table(HEAD, rows())))


ABOUT = """The scenes are those of `tests/support/stokes_contacts.py`: disks of radius .1 cm in a fluid of
density 1 and viscosity .3, pressed by their weight onto a wall with the range .03 cm; what is derived, and how, is in
[numerics](../numerics.md#contacts), and what it was before in [the decision](../decisions/43-stokes-contacts.md).

* force / weight: of the contacts with walls, its mean over the last fifth of the run, and the extremes there.
* speed: the highest in that fifth, and the highest ever.
* gap: at the end, less the one at which the contact bears the weight exactly, by bisection; of several bodies the
  least ever.
* created, lost: the extremes of the energy balance's residual after the first step, over what was put in.
* steps: made in all. Runs begin with steps of a 64th that at most double. A body starts from rest where it should move
  at once, and the second step's prediction knows of it: that counts as lost.

{rows}"""
