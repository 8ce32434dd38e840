"""The plot of displacements of mechanisms, of the whole and of each component."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.post.reports.curves import add_legend, escape_dollars, widen
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import BLACK, PALETTE, new_figure


def mechanism_plot(results: Results) -> Figure:
    """Plot each mechanism's displacement along each axis over time: the whole in black, components in colours."""
    motions, axes_names = results.system.motions, results.axes
    names = motions.names
    figure = new_figure(8.0, 1.2 + 1.8 * len(axes_names))
    panels = figure.subplots(len(axes_names), len(names), sharex=True, squeeze=False)
    single = len(motions.mass) - len(names)
    for column, name in enumerate(names):
        mine = np.flatnonzero(motions.carrier == single + column)
        for row, axis in enumerate(axes_names):
            _draw(panels[row][column], results, axis, column, mine.tolist())
        panels[0][column].set_title(escape_dollars(name))
        panels[-1][column].set_xlabel("time [time]")
    span = max(np.ptp(axes.get_ylim()) for axes in panels.flat)
    for axes in panels.flat:
        widen(axes, 0.1 * float(span))
    for row, axis in enumerate(axes_names):
        panels[row][0].set_ylabel(f"way along {axis} [length]")
    if len(names) == 1:
        add_legend(figure)
    return figure


def _draw(axes: Axes, results: Results, axis: str, whole: int, components: list[int]) -> None:
    values, names = results.bodies[axis], results.names
    for number, component in enumerate(components):
        colour = PALETTE[number % len(PALETTE)]
        way = values[:, component] - values[0, component]
        axes.plot(results.time, way, color=colour, linewidth=1.0, label=escape_dollars(names[component]))
    way = results.wholes[axis][:, whole] - results.wholes[axis][0, whole]
    axes.plot(results.time, way, color=BLACK, linewidth=1.6, label="whole")
