"""Impacts that lose energy: dry, and of a disk thrown at a wall in a fluid, beside what balls in liquids do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

from pages._studies import study_plot, study_table

SCENE = "rebound.toml"
SPEED, RESTITUTION, DECAY = 10.0, 0.8, 35.0
DRY = {
    "normal": [],
    "centre": ["contact.law=centre"],
    "contact": ["contact.law=contact", "contact.smallest_gap=0.01"],
    "barrier": ["contact.law=barrier"],
}
DRY_RESTITUTIONS = 0.05, 0.2, 0.5, 0.8, 0.95
VISCOSITIES = 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005
LAWS = {
    "elastic": ["contact.restitution=1.0"],
    "restitution": [],
    "stokes": [f"contact.restitution_stokes={DECAY}"],
}
STEPS = 0.001, 0.0005, 0.00025, 0.000125
HEADINGS = {"elastic": "e = 1", "restitution": "e = .8", "stokes": "e = .8 exp(-35/St)"}


class Impact:
    """Of one run: the speed at range and the highest one away [cm/s], the Stokes number at range, and its energies."""

    def __init__(self, run: Run) -> None:
        bodies = run.history.bodies
        reach = run.scene.contact.range
        near = int(np.argmax(bodies["gap"] < reach))
        gap, time = bodies["gap"][near - 1 : near + 1][::-1], bodies["time"][near - 1 : near + 1][::-1]
        self.arrival = -float(np.interp(np.interp(reach, gap, time), bodies["time"], bodies["vx"]))
        self.departure = float(bodies["vx"].max())
        self.energy = run.summary["energy"]
        disk, fluid = run.scene.body[0], run.scene.fluid
        diameter, moved = 2.0 * disk.radius, disk.density + fluid.density
        self.stokes = moved * diameter * self.arrival / (9.0 * fluid.viscosity)

    @property
    def rebound(self) -> float:
        """Highest speed away over the speed at range."""
        return self.departure / self.arrival


def page(work: Work) -> Page:
    """Dry impacts, rebounds over the Stokes number, halvings of the step, and the study."""
    dry = {law: [_dry(work, law, e) for e in DRY_RESTITUTIONS] for law in DRY}
    wet = {law: [_wet(work, law, viscosity) for viscosity in VISCOSITIES] for law in LAWS}
    halved = {
        law: [Impact(work.run(f"{law}_{step}", SCENE, [*LAWS[law], f"time.step={step}"])) for step in STEPS]
        for law in ("restitution", "stokes")
    }
    study = work.study("rebound")
    dry_error = max(abs(found - e) for row in dry.values() for found, e in zip(row, DRY_RESTITUTIONS, strict=True))
    created = max(100.0 * one.energy["created"] for row in (*wet.values(), *halved.values()) for one in row)
    text = TEXT.format(
        dry=table(
            ("law", *(f"e = {e:g}" for e in DRY_RESTITUTIONS)),
            [(f"`{law}`", *(f"{found:.4f}" for found in row)) for law, row in dry.items()],
        ),
        dry_error=f"{dry_error:.1e}",
        wet=table(
            ("viscosity", "thrown at St", "reaches range at St", *HEADINGS.values(), "formula"),
            _wet_rows(wet),
        ),
        halved=table(("law", "step [s]", "rebound", "created [%]", "lost [%]"), _halved_rows(halved)),
        created=f"{created:.2f}",
        **_shares(wet),
        study=study_table(study),
    )
    return Page("Impacts that lose energy", text, {"": rebounds(wet), "_study": study_plot(study)})


TEXT = """`scenes/rebound.toml`: a disk of density 8 is thrown at a wall at 10 cm/s. Rebound is the highest speed away
from the wall over the speed at which the disk reaches the law's range.

## Without a fluid

{dry}

The largest error of all is {dry_error}; it is of first order in the substep.

## In a fluid

St = (ρ_s + ρ_f) D v/(9μ), by the speed at which the disk is thrown, and by that at which it reaches range. The formula
is .8 exp(-35/St) of the latter. It was fitted to drops and balls (Legendre, Daniel and Guiraud 2005,
doi:10.1063/1.2010527), by the speed of the approach before any film; infinite cylinders have no such measurements.

{wet}

What of the loss is film and what is law: with e = 1 all of it is the film that the mesh resolves within range. In
brackets is the rebound over that with e = 1, which is the law's part. Film and law multiply: with e = .8 the law's part
is {least} to {most} where St at range is 10 or more, {judged} 2 % of .8. With exp(-35/St) it is the formula's to {off}
there.

So the loss within range counts twice with `restitution_stokes`, once as flow and once by the formula: {twice}. Film
thinner than the disk's smallest gap is missing from the flow; with e = .8 alone the disk comes back with {alone} there.
Range is a fifth of the radius here; the thinner it is beside the film that matters, the less counts twice.

## Halvings of the step

Energy created and lost by contacts and scheme, of all that was put in, for a viscosity of .02 g/s.

{halved}

Of all runs on this page the worst creates {created} % of what was put in.

## Error against run time

![Error against run time](restitution_study.png)

`studies/rebound.toml`, one knob at a time.

{study}"""


def _dry(work: Work, law: str, restitution: float) -> float:
    overrides = ["fluid.backend=dry", f"contact.restitution={restitution}", *DRY[law]]
    return Impact(work.run(f"dry_{law}_{restitution}", SCENE, overrides)).rebound


def _wet(work: Work, law: str, viscosity: float) -> Impact:
    return Impact(work.run(f"{law}_at_{viscosity}", SCENE, [*LAWS[law], f"fluid.viscosity={viscosity}"]))


def _formula(stokes: float) -> float:
    return float(RESTITUTION * np.exp(-DECAY / stokes))


def _wet_rows(wet: dict[str, list[Impact]]) -> Iterator[tuple[str, ...]]:
    for number, viscosity in enumerate(VISCOSITIES):
        elastic, *others = (wet[law][number] for law in LAWS)
        thrown = elastic.stokes * SPEED / elastic.arrival
        found = (f"{one.rebound:.3f} ({one.rebound / elastic.rebound:.3f})" for one in others)
        first = f"{viscosity:g}", f"{thrown:.3g}", f"{elastic.stokes:.3g}", f"{elastic.rebound:.3f}"
        yield (*first, *found, f"{_formula(elastic.stokes):.3f}")


def _shares(wet: dict[str, list[Impact]]) -> dict[str, str]:
    """What the laws take beside the film, where disks come back at all."""
    fast = [impacts for impacts in zip(*wet.values(), strict=True) if impacts[0].stokes >= 10.0]
    constant = [one.rebound / elastic.rebound for elastic, one, _ in fast]
    off = max(abs(one.rebound / elastic.rebound - _formula(elastic.stokes)) for elastic, _, one in fast)
    within = all(abs(share - RESTITUTION) < 0.02 * RESTITUTION for share in constant)
    elastic, alone, last = fast[0]
    return {
        "least": f"{min(constant):.3f}",
        "most": f"{max(constant):.3f}",
        "judged": "within" if within else "not within",
        "off": f"{off:.3f}",
        "alone": f"{alone.rebound:.3f}",
        "twice": f"{last.rebound:.3f} in place of {_formula(elastic.stokes):.3f} at St = {elastic.stokes:.3g}",
    }


def _halved_rows(halved: dict[str, list[Impact]]) -> Iterator[tuple[str, ...]]:
    for law, row in halved.items():
        for step, one in zip(STEPS, row, strict=True):
            shares = (f"{100.0 * one.energy[key]:.3f}" for key in ("created", "lost"))
            yield HEADINGS[law], f"{step:g}", f"{one.rebound:.4f}", *shares


def rebounds(wet: dict[str, list[Impact]]) -> Figure:
    """Rebound over the Stokes number at range."""
    figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
    axes = figure.add_subplot(xscale="log", xlabel="St at range", ylabel="rebound: speed after over speed before")
    for (law, row), marker in zip(wet.items(), "os^", strict=True):
        axes.plot(
            [one.stokes for one in row], [one.rebound for one in row], marker, label=f"in the fluid, {HEADINGS[law]}"
        )
    stokes = np.geomspace(2.0, 600.0, 200)
    axes.plot(stokes, RESTITUTION * np.exp(-DECAY / stokes), "k-", lw=1.0, label=".8 exp(-35/St)")
    axes.plot(stokes, np.exp(-DECAY / stokes), "k:", lw=1.0, label="exp(-35/St)")
    axes.set_ylim(0.0, 1.0)
    axes.legend()
    return figure
