"""The plots of a comparison: paths of all backends over each other, and how far they are apart over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.comparison.differences import UNITS, Pair, histories, label
from rigidfluid.post.comparison.runs import Run
from rigidfluid.post.reports.curves import add_legend, widen
from rigidfluid.post.reports.style import BLACK, PALETTE, new_figure

_SHOWN = ("position", "velocity", "hydrodynamic_force")
_DASHES = ("--", ":", "-.")
_NARROWEST = 0.1
"""Least span of a panel over that of the widest in its column, so that a drift of nothing looks like nothing."""


def body_plot(runs: Sequence[Run], body: int) -> Figure:
    """Plot position, velocity and fluid force of a body over time, by component; ``runs[0]`` is the reference."""
    results = [run.results for run in runs if run.results is not None]
    axes_names = results[0].axes
    figure = new_figure(11.0, 2.0 * len(axes_names) + 0.6)
    panels = figure.subplots(len(axes_names), len(_SHOWN), sharex=True, squeeze=False)
    for number, (run, found) in enumerate(zip(runs, results, strict=True)):
        values = histories(found)
        for column, name in enumerate(_SHOWN):
            for k, axes in enumerate(panels[:, column]):
                _draw(axes, found.time, values[name][:, body, k], run.backend, number)
    for column, name in enumerate(_SHOWN):
        panels[0][column].set_title(f"{label(name)} [{UNITS[name]}]")
        panels[-1][column].set_xlabel("time [time]")
        _share_scale(panels[:, column])
    for k, axis in enumerate(axes_names):
        panels[k][0].set_ylabel(axis)
    add_legend(figure)
    return figure


def difference_plot(pairs: Sequence[Pair]) -> Figure:
    """Plot the largest difference of any body over time, on a log scale: a panel per quantity, a line per pair."""
    figure = new_figure(11.0, 6.5)
    panels = figure.subplots(2, 3, sharex=True)
    for axes, (name, unit) in zip(panels.flat, UNITS.items(), strict=True):
        axes.set_title(f"{label(name)} [{unit}]")
        for pair, colour in zip(pairs, cycle(PALETTE)):
            largest = pair.differences[name].values.max(axis=1)
            axes.plot(pair.time, np.where(largest > 0.0, largest, np.nan), color=colour, label=pair.other)
        if any(pair.differences[name].largest != 0.0 for pair in pairs):  # also where it is no number
            axes.set_yscale("log")
        else:
            axes.text(0.5, 0.5, "no difference", transform=axes.transAxes, ha="center", va="center")
            axes.set_yticks([])
    for axes in panels[-1]:
        axes.set_xlabel("time [time]")
    lines, names = panels[0][0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside upper center", ncols=5)
    return figure


def most_different(pairs: Sequence[Pair], most: int) -> list[int]:
    """Numbers of the bodies with the largest differences of position, at most so many, in order."""
    largest = np.max([pair.differences["position"].values.max(axis=0) for pair in pairs], axis=0)
    return sorted(np.argsort(-largest, kind="stable")[:most].tolist())


def _draw(axes: Axes, time: FloatArray, values: FloatArray, name: str, number: int) -> None:
    """The reference broad and pale below the others, so that equal lines are seen to be."""
    if number == 0:
        axes.plot(time, values, color=BLACK, alpha=0.3, linewidth=4.0, label=name)
    else:
        dashes = _DASHES[(number - 1) % len(_DASHES)]
        axes.plot(time, values, color=PALETTE[(number - 1) % len(PALETTE)], linestyle=dashes, label=name)


def _share_scale(panels: Iterable[Axes]) -> None:
    spans = [np.ptp(axes.get_ylim()) for axes in panels]
    for axes in panels:
        widen(axes, _NARROWEST * float(max(spans)))
