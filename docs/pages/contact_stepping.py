"""Ways to step through contacts, without a fluid and in one, and force laws."""

from __future__ import annotations

from typing import Any

import numpy as np
from page_tools import Page, Work

from pages._studies import errors_by, scene_rows, study_plot
from rigidfluid.post.studies.results import Results

SINGLE, SUBSTEPS, IMPLICIT = "stepping substeps, substeps 1", "stepping substeps", "stepping implicit"


def page(work: Work) -> Page:
    """Errors over the steps of three studies."""
    dry, wet, laws = (work.study(f"contact_{name}") for name in ("stepping", "stepping_in_fluid", "laws"))
    text = ABOUT.format(
        dry=scene_rows(dry), wet=scene_rows(wet), laws=scene_rows(laws), **of_dry(dry), **of_wet(wet), **of_laws(laws)
    )
    plots = {"": study_plot(dry), "_in_fluid": study_plot(wet), "_laws": study_plot(laws)}
    return Page("Stepping through contacts", text, plots)


def of_dry(results: Results) -> dict[str, Any]:
    """What the text says of two disks without a fluid."""
    errors = errors_by(results)
    worst = max(errors[SUBSTEPS], key=errors[SUBSTEPS].__getitem__)
    return {
        "dry_failed": failures(results, SINGLE),
        "dry_long": max(errors[SUBSTEPS]),
        "dry_substeps": errors[SUBSTEPS][max(errors[SUBSTEPS])],
        "dry_implicit": errors[IMPLICIT][max(errors[IMPLICIT])],
        "dry_worst": errors[SUBSTEPS][worst],
        "dry_worst_step": worst,
        "first_order": order(errors[IMPLICIT], longest=True),
        "last_order": order(errors[IMPLICIT], longest=False),
    }


def of_wet(results: Results) -> dict[str, Any]:
    """What the text says of the disk in a fluid."""
    errors = errors_by(results)
    return {
        "wet_failed": failures(results, SINGLE),
        "wet_long": max(errors[SUBSTEPS]),
        **{f"wet_{name}": errors[way][max(errors[way])] for name, way in (("sub", SUBSTEPS), ("imp", IMPLICIT))},
    }


def of_laws(results: Results) -> dict[str, Any]:
    """What the text says of force laws, by their names."""
    errors = {label.split(",")[0].removeprefix("law "): found for label, found in errors_by(results).items()}
    long = max(set.intersection(*map(set, errors.values())))
    off = {law: found[long] for law, found in errors.items()}
    return {
        "long_step": long,
        "worst_law": max(off, key=off.__getitem__),
        "off": ", ".join(f"{error:.1e} with `{law}`" for law, error in off.items()),
        "orders": ", ".join(f"{order(found, longest=False):.1f} with `{law}`" for law, found in errors.items()),
    }


def order(errors: dict[float, float], longest: bool) -> float:
    """Of convergence between the three longest or the three shortest steps."""
    steps = sorted(errors)
    fine, coarse = (steps[-3], steps[-1]) if longest else (steps[0], steps[2])
    return float(np.log(errors[coarse] / errors[fine]) / np.log(coarse / fine))


def failures(results: Results, label: str) -> str:
    """The steps with which runs failed."""
    steps = set(results.study.tables.vary["time.step"]) - set(errors_by(results)[label])
    return f"steps of {', '.join(f'{step:g}' for step in sorted(steps, reverse=True))} s" if steps else "no step"


ABOUT = """Three ways through contacts: one explicit substep a step (`contact.substeps = 1`), as many
substeps as contacts need (the default), and one implicit step (`contact.stepping = "implicit"`). Runs that failed are
in the tables and not in the plots: without a fluid one explicit substep failed with {dry_failed}, in a fluid
with {wet_failed}. Seconds are of a machine that did other work as well.

**What to choose.** Substeps, unless there is a reason: with the longest step, {dry_long:g} s without a fluid and
{wet_long:g} s in one, their error is {dry_substeps:.1e} and {wet_sub:.1e}, that of the implicit step {dry_implicit:.1e}
and {wet_imp:.1e}. Implicit contacts where the energy must not drift, however long the run and the step are; not with
dampers that steps do not resolve. One explicit substep only where the step resolves every contact.

## Two disks without a fluid

`studies/contact_stepping.toml`, the plot above. Substeps find the moment of an impact within a step. They stay the same
through an impact, however many steps it lasts. In the second one the disks hit a wall and, before they leave it, the
floor; where that is foreseen in a later step, substeps change in the midst of the impact, which costs some energy.
Their largest error is {dry_worst:.1e}, with steps of {dry_worst_step:g} s. The implicit step keeps the energy; its
error is when the impact takes place, and is of order {first_order:.1f} between the three longest steps and
{last_order:.1f} between the three shortest.

{dry}

## A disk in a fluid

![A disk in a fluid](contact_stepping_in_fluid.png)

`studies/contact_stepping_in_fluid.toml`: the speed on the way up after an impact. The reference is known to 1e-4.
Until the step resolves the impact its error depends on where in a step the impact falls, so that single runs are right
by luck.

{wet}

## Force laws

![Force laws](contact_stepping_laws.png)

`studies/contact_laws.toml`: energy gained or lost with one explicit substep a step, for laws of equal strength: all
stop the fastest blow at a quarter of the range. With steps of {long_step:g} s, the longest with which no law fails, the
error is {off}: most with `{worst_law}`. `barrier` is the stiffest near contact. The force of `spring-dashpot` has a
kink at the range. Between the three shortest steps errors fall with the order {orders}.

{laws}"""
