"""The plot of a study: error against run time, both logarithmic."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from rigidfluid.post.reports.curves import escape_dollars
from rigidfluid.post.reports.style import BLACK, new_figure
from rigidfluid.post.studies.lines import draw_lines, knob_words
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.strict_table import Settings

CROWDED = 300.0
"""Ratio of times from which on only powers of ten have a label, as others would run into each other."""


def error_plot(results: Results) -> Figure:
    """Plot a line for each value of the group, through its runs in the order of the study file, and the Pareto front.

    With two keys in the group the first gives the colour, the second the marker. ``results`` has at least one point.
    """
    figure = new_figure(9.0, 5.0)
    axes = figure.subplots()
    shown = [*draw_lines(axes, _lines(results)), _draw_front(axes, results)]
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    seconds, errors = zip(*results.points.values(), strict=True)
    subdivisions = (1.0, 2.0, 5.0) if max(seconds) < CROWDED * min(seconds) else (1.0,)
    axes.xaxis.set_major_locator(LogLocator(subs=subdivisions))
    axes.set_xlim(*_limits(seconds))
    axes.set_ylim(*_limits(errors))
    axes.set_xlabel(f"{results.study.tables.study.clock} [s]")
    axes.set_ylabel(escape_dollars(error_label(results)))
    axes.grid(which="minor", alpha=0.12)
    figure.legend(handles=shown, loc="outside right upper")
    return figure


def error_label(results: Results) -> str:
    """Label of the error axis: the quantity and its reference."""
    kind = "relative error" if results.is_relative else "error"
    of = results.target.of if results.is_relative else results.target.figure_label
    return f"{kind} of {of}\nagainst {results.target.against}"


def _lines(results: Results) -> dict[tuple[str, ...], list[tuple[float, float]]]:
    """Points by values of the group, all in the order of the study file."""
    lines: dict[tuple[str, ...], list[tuple[float, float]]] = {}
    for key, settings in _settings(results).items():
        name = tuple(knob_words(results, knob, settings) for knob in results.study.tables.study.group)
        lines.setdefault(name or ("runs",), []).append(results.points[key])
    return lines


def _settings(results: Results) -> dict[str, Settings]:
    return {key: settings for key, settings in zip(results.prints, results.plan, strict=True) if key in results.points}


def _limits(values: Sequence[float]) -> tuple[float, float]:
    """A tenth more than the values span on a logarithmic scale, and never less than a factor of 1.5 to either side."""
    low, high = min(values), max(values)
    room = max((high / low) ** 0.1, 1.5)
    return low / room, high * room


def _draw_front(axes: Axes, results: Results) -> Artist:
    """Mark the front's runs and write their knobs next to them, but for the group, which the lines tell."""
    seconds, errors = zip(*(results.points[key] for key in results.front), strict=True)
    axes.plot(seconds, errors, drawstyle="steps-post", color=BLACK, alpha=0.15, linewidth=6.0, zorder=0)
    (rings,) = axes.plot(
        seconds, errors, "o", color=BLACK, markersize=13, fillstyle="none", label="Pareto front", zorder=0
    )
    shown = [key for key in results.study.knobs if key not in results.study.tables.study.group]
    settings = _settings(results)
    for key in results.front:
        words = "\n".join(knob_words(results, knob, settings[key]) for knob in shown if knob in settings[key])
        axes.annotate(words, results.points[key], (9, 7), textcoords="offset points", fontsize=8)
    return rings
