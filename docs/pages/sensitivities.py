"""Derivatives of a fall and of a bounce by values of their scenes: against differences of runs, and what they cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from page_tools import Page, Run, Work, table

SHARE = 3e-5
"""Half the difference of the values of two runs, relative to the value."""

QUANTITIES = ("place", "velocity", "force")
"""Quantities that are compared, in the order of a case's columns."""


@dataclass(frozen=True)
class Case:
    """A ``scene`` cut short by ``overrides``, the ``keys`` with their values in it, and the ``columns`` of the first
    body that are compared."""

    title: str
    scene: str
    overrides: tuple[str, ...]
    keys: Mapping[str, float]
    columns: tuple[str, ...]
    tight: tuple[str, ...] = ("fluid.tolerance=1e-12",)


CASES = {
    "fall": Case(
        "a disk falls",
        "falling_disk.toml",
        ("time.end=0.1",),
        {"body.0.density": 1.25, "fluid.density": 1.0, "fluid.viscosity": 0.1, "fluid.gravity.1": -981.0},
        ("y", "vy", "fy"),
    ),
    "driven": Case(
        "a disk is driven",
        "falling_disk.toml",
        ("time.end=0.02", "body.0.prescribed={amplitude=[0.0, 0.01], frequency=5.0}"),
        {"body.0.prescribed.amplitude.1": 0.01, "body.0.prescribed.frequency": 5.0, "fluid.viscosity": 0.1},
        ("y", "vy", "fy"),
    ),
    "sunk": Case(
        "a disk sinks onto the floor",
        "falling_disk.toml",
        ("time.end=0.03", "body.0.position=[1.0, 0.145]"),
        {"contact.epsilon_wall": 9e-7, "body.0.density": 1.25, "fluid.viscosity": 0.1},
        ("y", "vy", "fy"),
    ),
    "bounce": Case(
        "two disks collide without a fluid",
        "dry_bounce.toml",
        ("time.end=0.008",),
        {"contact.epsilon": 1e-8, "body.1.density": 1.0, "body.0.velocity.0": 20.0},
        ("x", "vx", "cfx"),
        tight=(),
    ),
}
"""Cases by the first word of their folders."""


class Compared:
    """Runs of a ``case``: one with derivatives, one without, and two for each key."""

    def __init__(self, work: Work, name: str, case: Case) -> None:
        self.case = case
        keys = ", ".join(f"'{key}'" for key in case.keys)
        self.watched = work.run(f"{name}_watched", case.scene, [*case.overrides, f"output.sensitivities=[{keys}]"])
        self.plain = work.run(f"{name}_plain", case.scene, case.overrides)
        self.pairs = {key: _pair(work, f"{name}_{key}", case, key) for key in case.keys}

    def derivative(self, key: str, column: str) -> np.ndarray:
        """Derivative over time as the run tells it, from its first step on."""
        rows = self.watched.history.sensitivities
        chosen = (rows["parameter"] == key) & (rows["body"] == self.body)
        return np.asarray(rows[column][chosen][-len(self.times) :])

    def difference(self, key: str, column: str) -> np.ndarray:
        """The same by the difference of two runs."""
        tables = (run.history.bodies for run in self.pairs[key])
        plus, minus = (bodies[column][bodies["body"] == self.body] for bodies in tables)
        return np.asarray((plus - minus)[1:] / (2.0 * SHARE * self.case.keys[key]))

    @property
    def times(self) -> np.ndarray:
        """Ends of the steps."""
        return np.asarray(self.watched.history.steps["time"])

    @property
    def body(self) -> str:
        """Name of the first body."""
        return str(self.watched.history.bodies["body"][0])

    def errors(self, key: str) -> list[float]:
        """Greatest difference of both in the last half of the steps, over the greatest derivative [1]; NaN of what does
        not depend on the key."""
        found = []
        for column in self.case.columns:
            told, expected = self.derivative(key, column), self.difference(key, column)
            most = np.abs(expected).max()
            found.append(np.abs(told - expected)[len(told) // 2 :].max() / most if most > 0.0 else np.nan)
        return found

    @property
    def cost(self) -> float:
        """CPU time that each key adds to the run, over that of the run without any [1]."""
        plain = self.plain.cpu_seconds
        return (self.watched.cpu_seconds - plain) / (len(self.case.keys) * plain)


def _pair(work: Work, label: str, case: Case, key: str) -> tuple[Run, Run]:
    """Runs with values on both sides of that of a ``key``, solved to a residual of 1e-12."""
    value = case.keys[key]
    plus, minus = (f"{key}={value * (1.0 + sign * SHARE)!r}" for sign in (1.0, -1.0))
    tight = (*case.overrides, *case.tight)
    return work.run(f"{label}_plus", case.scene, [*tight, plus]), work.run(
        f"{label}_minus", case.scene, [*tight, minus]
    )


def page(work: Work) -> Page:
    """Derivatives over time, and a table of their errors and costs."""
    found = [Compared(work, name, case) for name, case in CASES.items()]
    greatest = {name: _greatest(one) for name, one in zip(CASES, found, strict=True)}
    rows = [row for one in found for row in _rows(one)]
    head = (
        "",
        "key",
        *(f"error of the {name}'s" for name in QUANTITIES),
        "steps",
        "cost of a key over the run's",
    )
    free, touching = (max(greatest[name] for name in names) for names in (("fall", "driven"), ("sunk", "bounce")))
    text = ABOUT.format(table=table(head, rows), free=free, touching=touching, share=SHARE)
    return Page("Derivatives by values of a scene", text, {"": plot(found[0])})


def _greatest(one: Compared) -> float:
    return float(np.nanmax([one.errors(key) for key in one.case.keys]))


def _rows(one: Compared) -> Iterable[tuple[str, ...]]:
    for key in one.case.keys:
        errors = ("none" if np.isnan(error) else f"{error:.1e}" for error in one.errors(key))
        yield one.case.title, f"`{key}`", *errors, f"{len(one.times)}", f"{one.cost:.2f}"


def plot(one: Compared) -> Figure:
    """Elasticities of place and velocity over time, by the run and by differences."""
    figure = Figure(figsize=(9.0, 4.0), dpi=120, layout="constrained")
    for axes, column, name in zip(figure.subplots(1, 2), one.case.columns[:2], QUANTITIES[:2], strict=True):
        for key, value in one.case.keys.items():
            (line,) = axes.plot(one.times, value * one.derivative(key, column), label=key)
            axes.plot(
                one.times[::10], value * one.difference(key, column)[::10], "o", mfc="none", color=line.get_color()
            )
        axes.set(xlabel="time [s]", ylabel=f"p · derivative of the {name} [cm{'/s' if column == 'vy' else ''}]")
    axes.legend(fontsize=8)
    return figure


ABOUT = """`output.sensitivities` compared with differences of whole runs, whose value p of the key differs by
±{share:g} of it, and whose systems are solved to 1e-12; the runs with derivatives are solved to the usual 1e-9. Errors
are the greatest in the last half of the steps, over the greatest derivative in the run. In the figure lines are
derivatives by the run, each times the value of its key; circles are differences. What is prescribed depends on no
viscosity ("none").

{table}

The greatest error is {free:.1e} without contacts, and {touching:.1e} in contacts: there path and flow agree to a
thousandth of a step, and no run is smoother than that in its values. The cost
is the CPU time that each key adds, over that of the same run without derivatives; a difference of two runs costs 2, and
near contacts a key does too. How derivatives are found, and where they end, is in
[decision 111](../decisions/111-sensitivities.md)."""
