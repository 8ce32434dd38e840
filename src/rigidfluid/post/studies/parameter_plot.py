"""The plot of a study over a physical parameter: the figure, and its error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.post.reports.curves import escape_dollars
from rigidfluid.post.reports.style import BLACK, new_figure
from rigidfluid.post.studies.lines import draw_lines, scale_axis, settings_words
from rigidfluid.post.studies.plot import error_label
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import text_of


def parameter_plot(results: Results) -> Figure:
    """Plot the figure, and below it the error where there is one, over the first parameter.

    A line for each other setting: the colour by the other parameters, if there are any, the marker by the numerical
    ones. ``results`` has at least one outcome.
    """
    figures = {key: outcome.figure for key, outcome in results.outcomes.items()}
    errors = {key: point[1] for key, point in results.points.items()}
    figure = new_figure(9.0, 7.0 if errors else 4.5)
    panels = figure.subplots(2 if errors else 1, 1, sharex=True, squeeze=False)[:, 0]
    shown = _draw(panels[0], results, figures)
    panels[0].set_ylabel(escape_dollars(results.target.figure_label))
    _draw_slopes(panels[0], results)
    if errors:
        _draw(panels[1], results, errors)
        panels[1].set_yscale("log")
        panels[1].set_ylabel(escape_dollars(error_label(results)))
    _label_axis(panels[-1], results)
    if len(shown) > 1:
        figure.legend(handles=shown, loc="outside right upper")
    return figure


def _draw(axes: Axes, results: Results, values: Mapping[str, float]) -> list[Artist]:
    """Draw ``values`` by fingerprint over the first parameter; return the legend's artists."""
    first, *others = results.study.parameters
    places = _places(results.study.values(first))
    lines: dict[tuple[str, ...], list[tuple[float, float]]] = {}
    for key, settings in zip(results.prints, results.plan, strict=True):
        if key in values:
            names = (settings_words(results, knobs, settings) for knobs in (others, results.study.tables.vary))
            name = tuple(filter(None, names)) or ("runs",)
            lines.setdefault(name, []).append((places[text_of(settings[first])], values[key]))
    return draw_lines(axes, {name: sorted(points) for name, points in lines.items()})


def _draw_slopes(axes: Axes, results: Results) -> None:
    """Draw the tangent of the figure at each run that knows it, a quarter of the way to the next values."""
    first = results.study.parameters[0]
    values = results.study.values(first)
    if not _are_numbers(values) or len(values) < 2:
        return
    half = 0.25 * float(np.diff(np.sort(values)).min())
    for key, settings in zip(results.prints, results.plan, strict=True):
        outcome = results.outcomes.get(key)
        if outcome is not None and outcome.slope is not None:
            ends = np.array([-half, half])
            axes.plot(settings[first] + ends, outcome.figure + outcome.slope * ends, color=BLACK, linewidth=2.0)


def _are_numbers(values: list[Any]) -> bool:
    return all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)


def _places(values: list[Any]) -> dict[str, float]:
    """Places on the axis: numbers by their size, all else one after the other."""
    if _are_numbers(values):
        return {text_of(value): float(value) for value in values}
    return {text_of(value): float(place) for place, value in enumerate(values)}


def _label_axis(axes: Axes, results: Results) -> None:
    first = results.study.parameters[0]
    values = results.study.values(first)
    axes.set_xlabel(escape_dollars(results.target.axis_label(first)))
    if not _are_numbers(values):
        axes.set_xticks(range(len(values)), [escape_dollars(text_of(value)) for value in values])
    else:
        scale_axis(axes, values)
