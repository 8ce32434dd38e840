"""Error against run time, one setting of a scene at a time: runs of one page, in a table and a plot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from matplotlib.figure import Figure
from page_tools import Run, Work, table

SHIPPED = "as shipped"

Values = Mapping[str, Sequence[object]]
"""Values to try, by dotted key of the scene."""


@dataclass(frozen=True)
class OneKnob:
    """A scene, cut short by the overrides ``common``, and a ``figure``: its error is that from the run with ``finest``.

    ``name`` says what the figure is. ``values`` are tried one at a time, all other settings stay as shipped.
    """

    scene: str
    name: str
    common: Sequence[str]
    finest: Sequence[str]
    values: Values
    figure: Callable[[Run], float]

    def measure(self, work: Work) -> Measured:
        """Run what is not kept."""
        runs = {(SHIPPED, ""): work.run("study/shipped", self.scene, self.common)}
        for key, values in self.values.items():
            for value in values:
                override = f"{key}={value}"
                runs[key, str(value)] = work.run(f"study/{override}", self.scene, [*self.common, override])
        return Measured(self, runs, work.run("study/finest", self.scene, [*self.common, *self.finest]))


@dataclass(frozen=True)
class Measured:
    """A study's ``runs`` by key and value, and its ``finest``."""

    study: OneKnob
    runs: dict[tuple[str, str], Run]
    finest: Run

    @cached_property
    def figures(self) -> dict[tuple[str, str], float]:
        """Of each run but the finest."""
        return {setting: self.study.figure(run) for setting, run in self.runs.items()}

    @cached_property
    def reference(self) -> float:
        """The figure of the finest run."""
        return self.study.figure(self.finest)

    def error(self, setting: tuple[str, str]) -> float:
        """|figure - reference|."""
        return abs(self.figures[setting] - self.reference)

    def section(self, page: str) -> str:
        """A part of a page, which shows the plot as PAGE_study.png."""
        rows = [
            (
                f"`{key} = {value}`" if value else key,
                f"{self.figures[key, value]:.6f}",
                f"{self.error((key, value)):.1e}",
                *_cost(run),
            )
            for (key, value), run in self.runs.items()
        ]
        rows.append(("finest", f"{self.reference:.6f}", "", *_cost(self.finest)))
        head = ("setting", self.study.name, "error", "unknowns", "steps", "new meshes", "CPU [s]")
        finest = ", ".join(f"`{override}`" for override in self.study.finest)
        return f"""\
## Error against run time

The {self.study.name}: one setting at a time differs from the shipped scene; the error is the distance from the finest
run ({finest}). CPU seconds are those of one thread on a machine that other programs used too.

![Error against run time]({page}_study.png)

{table(head, rows)}"""

    def plot(self) -> Figure:
        """Error over CPU seconds, a line for each key through the shipped setting, in the order of the seconds."""
        figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
        axes = figure.add_subplot(xscale="log", yscale="log", xlabel="CPU seconds of one thread")
        axes.set_ylabel(f"error: {self.study.name}")
        shipped = (SHIPPED, "")
        for key in self.study.values:
            line = sorted([shipped, *(one for one in self.runs if one[0] == key)], key=self._seconds)
            points = [(self._seconds(one), self.error(one)) for one in line]
            axes.plot(*zip(*points, strict=True), "o-", mfc="none", label=key)
        axes.plot(self._seconds(shipped), self.error(shipped), "ks", label=SHIPPED)
        axes.grid(which="both", alpha=0.3)
        axes.legend(fontsize=8)
        return figure

    def _seconds(self, setting: tuple[str, str]) -> float:
        return self.runs[setting].cpu_seconds


def _cost(run: Run) -> tuple[str, str, str, str]:
    summary = run.summary
    return f"{summary['unknowns']}", f"{summary['steps']}", f"{summary['remeshes']}", f"{run.cpu_seconds:.0f}"
