"""Energy created and lost by stiff contacts in a fluid, over the step."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from fluid_contact_table import CASES, made
from fluid_contacts import created_and_lost, put_in
from page_tools import Page, Work, table

STEPPINGS = ("substeps", "implicit")

IN_FLUID = ("dropped", "bounce", "cradle", "cradle_light", "head_on", "light", "stacked", "squeezed", "film")

AT_REST = ("resting", "resting_stiff", "settling")

SHARES = ("created [%]", "lost [%]", "friction [%]", "first step [%]", "grad-div [%]")
HEAD = ("case", "stepping", "step [ms]", *SHARES, "figures")

MOST_LOST = {4.0: 30.0, 2.0: 15.0, 1.0: 7.0, 0.5: 4.0}


def page(work: Work) -> Page:
    """A row for each case, stepping and step, and which are above what is aimed at."""
    steps = (4.0, 2.0, 1.0, 0.5, 0.25)
    energies = [found for case in IN_FLUID for stepping in STEPPINGS for found in tries(work, case, stepping, steps)]
    resting = [found for case in AT_REST for found in tries(work, case, "substeps", (10.0, 4.0, 1.0))]
    over = [" ".join(found[:3]) for found in energies + resting if exceeds(found)]
    created = max(float(found[3] or 0.0) for found in energies)
    tables = {"energies": table(HEAD, energies), "resting": table(HEAD, resting)}
    text = ABOUT.format(over=", ".join(over) or "none", created=created, **tables)
    return Page("Stiff contacts in a fluid", text)


def tries(work: Work, case: str, stepping: str, steps: tuple[float, ...]) -> Iterable[tuple[str, ...]]:
    """A row for each step of a case that is meant for this stepping."""
    for step in steps:
        scene = made(case, 1e-3 * step, stepping)
        if scene is None:
            continue
        run = work.run(f"{case}_{stepping}_{step:g}ms", scene, may_stop=True)
        history, status = run.history, run.summary["status"]
        if status != "complete":
            yield case, stepping, f"{step:g}", *[""] * 5, status
            continue
        whole = max(put_in(history), np.finfo(float).tiny)
        friction, stabilised = (history.energy[name][-1] / whole for name in ("path_friction", "grad_div_loss"))
        created, lost, first = created_and_lost(history)
        shares = (f"{100.0 * share:.2f}" for share in (created, lost, friction, first, stabilised))
        yield case, stepping, f"{step:g}", *shares, CASES[case][1](history).replace("|", "\\|")


def exceeds(found: tuple[str, ...]) -> bool:
    """Whether a row is above what is aimed at: created 3 %, from 1 ms down 1 %; lost as in MOST_LOST."""
    _, _, step, created, lost, *_ = found
    if not created:
        return True
    most = 3.0 if float(step) > 1.0 else 1.0
    return float(created) > most or float(lost) > MOST_LOST.get(float(step), np.inf)


ABOUT = """The scenes are those of `tests/support/fluid_contacts.py`: disks of radius .1 cm and density 3 in
water, with contacts that are ten to a thousand times shorter than a step; what is derived, and how, is in
[numerics](../numerics.md#contacts).

* created: the most negative residual of the energy balance after the first step, less the first step's own; lost: the
  most positive. Both over what was put in, energy stored at the start and the most that gravity and driven
  bodies had worked.
* friction: `path_friction`, what the bodies' friction took between the fluid's solutions, over the same. It explains up
  to so much of what was lost; it is no part of the residual.
* first step: what it created.
* grad-div: what [stabilisation](../numerics.md#grad-div) took until the end, no part of the others.

Aimed at are at most 3 % created, and 1 % with steps of 1 ms and less, and at most 30, 15, 7 and 4 % lost with steps of
4, 2, 1 and .5 ms. Above that are: {over}.

A step in which an impact would lose much is shortened, to an eighth at most. In the squeezed channel both walls push
the disk all the time.

Beside the page of 2026-11-22 ({created:.2f} % are created at most; then .39 %) more is lost in some cases: dropped
4.36 % then at 4 ms, stacked 2.83 % at 4 ms and .03 % at .25 ms, head_on .37 % at .25 ms, settling 1.77 % at 1 ms.
Responses of the bodies to impulses were then off by up to .6 %; solved for more exactly, dropped loses 3.34 % at 4 ms,
settling 1.83 % at 1 ms, stacked 3.30 % at 4 ms and .24 % at .25 ms, head_on .67 % at .25 ms. What is left beyond the
figures of 2026-11-22 has not been put to a cause. New meshes keep cells next to bodies since, which changes the rebound
of head_on, from 6.31 to 6.19 cm/s. It is nearer to what finer meshes give: with size_body .03, .015, .0075 cm at 1 ms
6.19, 5.84, 5.71 cm/s now and 6.31, 5.92, 5.72 then. Without stabilisation .62 % in place of .86 % is lost there at .5
ms.

{energies}

## Rest

F/W is the contact's force over the weight in the last fifth of the run, mean and extremes. Where next to nothing was
put in, the shares of energy mean little.

{resting}"""
