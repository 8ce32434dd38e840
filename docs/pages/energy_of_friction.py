"""Energy created and lost in contacts whose friction has springs along the surfaces, over the step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial

import rough_contacts as scenes
from fluid_contacts import Stepping, created_and_lost, put_in
from page_tools import Page, Work, table
from page_tools.cpu_time import cpu_seconds
from page_tools.kept_rows import Row

import rigidfluid
from rigidfluid.core.scene.scene import Scene

STEPS = (4.0, 2.0, 1.0, 0.5)
"""Steps of all cases [ms]."""
STEPPINGS: tuple[Stepping, ...] = ("substeps", "implicit")
ALLOWED = 0.005

Make = Callable[[float, Stepping], Scene]
DRY: dict[str, Make] = {
    **{f"two balls and a floor, `{law}`": partial(scenes.hits, law) for law in scenes.LAWS},
    "bricks": scenes.bricks,
    "dominoes": scenes.dominoes,
    "gears": scenes.gears,
}
WET: dict[str, Make] = {
    "disk": scenes.wet_disk,
    "disk, `normal`": scenes.wet_rolling,
    "block": scenes.wet_block,
}


def page(work: Work) -> Page:
    """What is created and lost in each case, by each stepping and step."""
    rows = work.cases(_cases())
    beyond = [f"{row['case']} ms" for row in rows if row["created"] > ALLOWED]
    text = ABOUT.format(
        allowed=f"{ALLOWED:.1%}",
        beyond="; ".join(beyond) or "none",
        runs=len(rows),
        dry=_table(DRY, rows),
        wet=_table(WET, rows),
        dry_created=_most("created", DRY, rows),
        wet_created=_most("created", WET, rows),
        dry_lost=_most("lost", DRY, rows),
        wet_lost=_most("lost", WET, rows),
    )
    return Page("Energy of contacts with friction", text)


def _cases() -> dict[str, Callable[[], Iterable[Row]]]:
    """A run for each."""
    return {
        f"{name}, {stepping}, {step:g}": partial(_row, name, make, stepping, step)
        for name, make in (WET | DRY).items()
        for stepping in STEPPINGS
        for step in STEPS
    }


def _row(name: str, make: Make, stepping: Stepping, step: float) -> Iterator[Row]:
    """Shares of the energy that was put into a run."""
    start, history = cpu_seconds(), rigidfluid.run(make(1e-3 * step, stepping))
    created, lost, _ = created_and_lost(history)
    yield {
        "name": name,
        "stepping": stepping,
        "step": step,
        "created": created,
        "lost": lost,
        "taken": float(history.energy["contact_loss"][-1]) / put_in(history),
        "seconds": round(cpu_seconds() - start, 1),
    }


def _table(cases: Iterable[str], rows: Sequence[Row]) -> str:
    """A line for each case and stepping."""
    lines = []
    for name in cases:
        for stepping in STEPPINGS:
            mine = [row for row in rows if (row["name"], row["stepping"]) == (name, stepping)]
            taken = [100.0 * row["taken"] for row in mine]
            shares = (f"{100.0 * row['created'] + 0.0:.3f}, {100.0 * row['lost'] + 0.0:.3f}" for row in mine)
            spent = f"{sum(row['seconds'] for row in mine):.0f}"
            lines.append((name, stepping, *shares, f"{min(taken):.0f} … {max(taken):.0f}", spent))
    return table(("case", "stepping", *(f"{step:g} ms" for step in STEPS), "taken [%]", "CPU time [s]"), lines)


def _most(share: str, cases: Iterable[str], rows: Sequence[Row]) -> str:
    return f"{max(row[share] for row in rows if row['name'] in cases):.3%}"


ABOUT = """In the scenes of `tests/support/rough_contacts.py` surfaces stick and slip: friction has springs along the
surfaces. Columns are created, lost [%], as [in a fluid without friction](contacts_in_fluid.md): the most negative
residual of the energy balance after the first step, less the first step's own, and the most positive, over what was put
in. Taken is what dashpots, friction and restitution took until the end, over the same, a part of the balance; its range
is that of the steps.

Above {allowed} created are, of {runs} runs: {beyond}. Without friction two of the [extreme contacts](stability.md) come
nearest to it, both in implicit steps of 4 ms: a disk that two walls squeeze from the start, and one that is let fall a
little way onto a very stiff contact ([why](../decisions/79-impacts-resolved-further.md)).

Implicit steps balance to round-off without a fluid. What dashpots take in impacts shorter than a step depends on the
step then, with `spring-dashpot` most.

## Without a fluid

At most {dry_created} is created, and {dry_lost} lost.

* Two balls: one of radius .1 that spins about all axes and flies at 3.6 hits another of twice the density beside its
  centre, and both hit the floor. Each law that repels has friction .3, resistance to rolling and twisting of .1 and
  restitution .8.
* Bricks: three settle on each other. Dominoes: one falls on another. Gears: a wheel of 8 teeth drives one of 10.
  All by `spring-dashpot`; gravity and sizes are of order 10 and .1 to 1.

{dry}

## In a fluid

At most {wet_created} is created, and {wet_lost} lost.

A disk of radius .1 cm, or a block of .24 by .14 cm, of density 3 falls through water at a slant, at 9.4 cm/s at first,
onto the floor. The laws have a restitution of .7 and friction of .5; disks resist rolling, by a coefficient of .1. All
is by `spring-dashpot` unless the case says `normal`, which yields as far in the first impact. A sphere with `roughness`
and friction in a liquid, by `normal`, is on [its own page](oblique_in_liquid.md).

{wet}"""
