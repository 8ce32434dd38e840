"""The plot of a study of random samples: the figure over each parameter, its quantiles, and Sobol indices."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from math import ceil

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.post.reports.curves import add_legend, escape_dollars
from rigidfluid.post.reports.style import PALETTE, new_figure
from rigidfluid.post.studies.lines import scale_axis, settings_words
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.sampled import Sampled

_COLUMNS = 3
"""Most panels side by side."""


def samples_plot(results: Results, samples: Sequence[Sampled]) -> Figure:
    """Plot the figure of each sample over each parameter, with its median and the band from 5 to 95 %, and below them
    Sobol indices where there are any; a colour for each numerical setting."""
    names = results.study.parameters
    columns = min(_COLUMNS, len(names))
    rows, has_indices = ceil(len(names) / columns), any(one.indices for one in samples)
    figure = new_figure(3.2 * columns + 2.0, 3.0 * (rows + has_indices) + 0.6)
    layout = figure.add_gridspec(rows + has_indices, columns)
    first: Axes | None = None
    for place, name in enumerate(names):
        axes = figure.add_subplot(layout[place // columns, place % columns], sharey=first)
        first = first or axes
        _draw_samples(axes, results, samples, name)
        if place % columns == 0:
            axes.set_ylabel(escape_dollars(results.target.figure_label))
        else:
            axes.tick_params(labelleft=False)
    if has_indices:
        _draw_indices(figure.add_subplot(layout[rows, :]), results, samples)
    add_legend(figure)
    return figure


def _draw_samples(axes: Axes, results: Results, samples: Sequence[Sampled], name: str) -> None:
    values = np.array([group[name] for group in results.study.groups])
    for one, colour in zip(samples, cycle(PALETTE)):
        if not len(one.known):
            continue
        low, median, high = one.quantiles
        label = settings_words(results, one.variant, one.variant) or "samples"
        axes.plot(values, one.figures, ".", color=colour, alpha=0.5, markersize=4.0, label=label)
        axes.axhline(median, color=colour, linewidth=1.0)
        axes.axhspan(low, high, color=colour, alpha=0.1, linewidth=0.0)
    scale_axis(axes, values.tolist())
    axes.set_xlabel(escape_dollars(results.target.axis_label(name)))


def _draw_indices(axes: Axes, results: Results, samples: Sequence[Sampled]) -> None:
    """First-order indices full, total ones in outline, with their 95 % confidence."""
    names = results.study.parameters
    width = 0.8 / (2 * len(samples))
    for number, (one, colour) in enumerate(zip(samples, cycle(PALETTE))):
        found = [one.indices[name] for name in names if name in one.indices]
        places = np.arange(len(found)) - 0.4 + (2 * number + 0.5) * width
        first, first_error, total, total_error = np.array(
            [(each.first, each.first_confidence, each.total, each.total_confidence) for each in found]
        ).reshape(-1, 4).T  # fmt: skip
        axes.bar(places, first, width, yerr=first_error, color=colour, capsize=3.0)
        axes.bar(places + width, total, width, yerr=total_error, color="none", edgecolor=colour, capsize=3.0)
    axes.set_xticks(range(len(names)), [escape_dollars(name) for name in names])
    axes.set_ylabel("Sobol index:\nfirst order full, total in outline")
    axes.axhline(0.0, color="black", linewidth=0.6)
