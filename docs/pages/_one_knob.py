"""Error against run time, one setting of a scene at a time: runs of one page, in a table and a plot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from page_tools import Run, Work, table

SHIPPED = "as shipped"

Values = Mapping[str, Sequence[object]]
"""Values to try, by dotted key of the scene."""


@dataclass(frozen=True)
class OneKnob:
    """A scene, cut short by the overrides ``common``, and the ``figure`` whose error is that from the ``finest`` overrides.

    Other knobs than the varied one stay as the scene ships them.
    """

    scene: str
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
        finest = work.run("study/finest", self.scene, [*self.common, *self.finest])
        return Measured(runs, finest, {setting: self.figure(run) for setting, run in runs.items()}, self.figure(finest))


@dataclass(frozen=True)
class Measured:
    """The ``runs`` and their ``figures`` by key and value, the ``finest`` run and the ``reference`` that it gives."""

    runs: dict[tuple[str, str], Run]
    finest: Run
    figures: dict[tuple[str, str], float]
    reference: float

    def error(self, setting: tuple[str, str]) -> float:
        """|figure - reference|."""
        return abs(self.figures[setting] - self.reference)

    def table(self, name: str) -> str:
        """A row for each run, the finest last."""
        rows = [
            (
                f"`{key} = {value}`" if value else key,
                f"{self.figures[key, value]:.5f}",
                f"{self.error((key, value)):.1e}",
            )
            + _cost(run)
            for (key, value), run in self.runs.items()
        ]
        rows.append(("finest", f"{self.reference:.5f}", "", *_cost(self.finest)))
        return table(("setting", name, "error", "unknowns", "steps", "new meshes", "CPU [s]"), rows)

    def plot(self, name: str) -> Figure:
        """Error over CPU seconds, a line for each key through the shipped setting, in the order of the seconds."""
        figure = Figure(figsize=(7.0, 4.2), dpi=120, layout="constrained")
        axes = figure.add_subplot(
            xscale="log", yscale="log", xlabel="CPU seconds of one thread", ylabel=f"error of the {name}"
        )
        shipped = (SHIPPED, "")
        for key in dict.fromkeys(key for key, _ in self.runs if key != SHIPPED):
            line = sorted([shipped, *(one for one in self.runs if one[0] == key)], key=self._seconds)
            points = [(self._seconds(one), self.error(one)) for one in line]
            axes.plot(*zip(*points, strict=True), "o-", mfc="none", label=key)
        axes.plot(self._seconds(shipped), self.error(shipped), "ks", label=SHIPPED)
        axes.grid(which="both", alpha=0.3)
        axes.legend()
        return figure

    def _seconds(self, setting: tuple[str, str]) -> float:
        return self.runs[setting].cpu_seconds


def _cost(run: Run) -> tuple[str, str, str, str]:
    summary = run.summary
    return f"{summary['unknowns']}", f"{summary['steps']}", f"{summary['remeshes']}", f"{run.cpu_seconds:.0f}"
