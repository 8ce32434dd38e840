"""Errors over CPU seconds, with fixed steps and with tolerances, of two scenes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from adaptive_step import FALLING, STARTED, Case, Outcome, settings
from matplotlib.figure import Figure
from page_tools import Page, Work, table

CASES = {"falling": ("falling disk", FALLING), "started": ("flow started at once", STARTED)}
"""By the first word of their folders: the heading, and what is run."""

Errors = dict[str, float]


@dataclass(frozen=True)
class Outcomes:
    """Of one case: the runs with fixed steps and with tolerances, each with its errors."""

    fixed: list[tuple[Outcome, Errors]]
    free: list[tuple[Outcome, Errors]]

    @classmethod
    def of(cls, work: Work, name: str, case: Case) -> Outcomes:
        """All runs of a case, against its reference."""
        runs = [
            (label, work.run(f"{name}_{label}".replace(" ", "_"), case.scene, changes))
            for label, changes in settings(case)
        ]
        reference, *others = [Outcome(label, run.cpu_seconds, run.history) for label, run in runs]
        found = [(run, case.errors(run.history, reference.history)) for run in others]
        return cls(found[: len(case.steps)], found[len(case.steps) :])

    def shares(self, name: str) -> str:
        """Of the tolerances: CPU seconds over those that fixed steps need until the error is as small, interpolated."""
        path = [(np.log(run.seconds), np.log(errors[name])) for run, errors in self.fixed]
        told = []
        for run, errors in self.free:
            needed = _reaches(path, np.log(errors[name]))
            if needed is not None:
                told.append(f"{run.seconds / np.exp(needed):.2f} with {run.label.removeprefix('tolerance ')}")
        return ", ".join(told) or "none"

    @property
    def table(self) -> str:
        """A row for each run."""
        head = ("", "CPU s", "steps", "rejected", *self.fixed[0][1], "created [%]", "lost [%]")
        return table(head, (row(*pair) for pair in [*self.fixed, *self.free]))


def _reaches(path: list[tuple[float, float]], error: float) -> float | None:
    """Where a path of (seconds, error) first comes down to an error; None if it does not, or begins below it."""
    for (before, high), (after, low) in pairwise(path):
        if high > error >= low:
            return before + (after - before) * (high - error) / (high - low)
    return None


def page(work: Work) -> Page:
    """Errors over CPU seconds."""
    found = {title: Outcomes.of(work, name, case) for name, (title, case) in CASES.items()}
    falling, started = found.values()
    height = "height, greatest [cm]"
    text = ABOUT.format(
        falling=falling.table,
        started=started.table,
        velocity=falling.shares("velocity, rms"),
        passage=falling.shares("passage, greatest [s]"),
        heights=", ".join(f"{errors[height]:.1e} with {run.label.split()[1]}" for run, errors in falling.free),
        **{
            name: started.shares(column)
            for name, column in zip(("drag", "drag_early", "kinetic"), started.fixed[0][1], strict=True)
        },
        lost=100.0 * max(run.history.summary["energy"]["lost"] for run, _ in started.free),
        rejected=max(share_rejected(run) for one in found.values() for run, _ in one.free),
    )
    return Page("Steps by a tolerance", text, {"": plots(found)})


def share_rejected(run: Outcome) -> float:
    """Rejected steps over all."""
    return run.history.summary["rejected_steps"] / run.history.summary["steps"]


def plots(found: dict[str, Outcomes]) -> Figure:
    """Two errors over CPU seconds, and steps over time, of each case."""
    figure = Figure(figsize=(12.0, 7.0), dpi=100, layout="constrained")
    for panels, (title, one) in zip(figure.subplots(2, 3), found.items(), strict=True):
        names = list(one.fixed[0][1])
        shown = ("velocity, rms", "passage, greatest [s]") if title == "falling disk" else names[:2]
        for axes, name in zip(panels, shown, strict=False):
            for pairs, style, label in ((one.fixed, "o-", "fixed steps"), (one.free, "s-", "tolerances")):
                axes.loglog(
                    [run.seconds for run, _ in pairs], [errors[name] for _, errors in pairs], style, label=label
                )
            axes.set(xlabel="CPU seconds", ylabel=f"error of {name}", title=title)
        for run, _ in one.free:
            times = run.history.energy["time"]
            panels[-1].step(times[1:], np.diff(times), where="pre", label=run.label)
        panels[-1].set(xlabel="time [s]", ylabel="step [s]", yscale="log", title=title)
        panels[0].legend()
        panels[-1].legend()
    return figure


def row(run: Outcome, errors: Errors) -> tuple[str, ...]:
    """A run in the table: what it cost, its errors, and its balance of energy."""
    summary = run.history.summary
    cost = f"{run.seconds:.1f}", f"{summary['steps']}", f"{summary['rejected_steps']}"
    balance = (f"{100.0 * summary['energy'][name]:.3f}" for name in ("created", "lost"))
    return run.label, *cost, *(f"{error:.1e}" for error in errors.values()), *balance


ABOUT = """`time.tolerance` compared with fixed steps, on one mesh size each. Errors are those against the same
scene with a step of .25 ms (falling disk) and 3.125 ms (flow started at once); CPU seconds of one thread, start and
meshes included. Runs with a tolerance have a longest step of 32 ms and .4 s. How steps are chosen is in
[numerics](../numerics.md#steps-by-a-tolerance).

Ratios below are CPU seconds with a tolerance over those with which fixed steps first come down to the same error,
interpolated between them: below 1 the tolerance is cheaper. A tolerance is left out where fixed steps do not come down
to its error, or the longest is below it.

**What to choose.** A tolerance where phases differ: a flow or a body that starts at once, a body that lands, comes
to rest or starts late. .001 is a good first guess. Fixed steps where the motion changes little, where only
positions count, and in bounces.

## A falling disk until it has landed

`scenes/falling_disk.toml` with `size_body` .025. Passage: of 2, 1 and .5 cm.

* Ratio of CPU seconds for the velocity, root mean square: {velocity}.
* Ratio of CPU seconds for times of passage: {passage}.
* Errors of fixed steps are small in times of passage by cancellation: what height a long first step loses,
  Adams–Bashforth 2 takes back later with the other sign. With a tolerance the start is exact, and the later errors,
  all of one sign, add up.
* Errors of the height [cm]: {heights}.

{falling}

## A flow started at once

`scenes/dfg_cylinder.toml` with `size_body` .006: a cylinder that is held in a stream which starts in the first
step. The mesh stays as it is.

* Ratio of CPU seconds for the drag after .2 s: {drag}.
* Ratio of CPU seconds for the drag from .02 s on: {drag_early}.
* Ratio of CPU seconds for the kinetic energy: {kinetic}.
* Energy is not lost, as the flow begins as the potential flow of a [start at once](../numerics.md#impulsive-starts):
  at most {lost:.1g} % in any run.

{started}

## Changes of step, and impacts

At most {rejected:.1%} of the steps are rejected. In an impact a tolerance says nothing: contacts have their
substeps."""
