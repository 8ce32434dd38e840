"""The plot of a study: error against wall time, both logarithmic."""

from __future__ import annotations

from itertools import cycle

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.reports.style import BLACK, PALETTE, new_figure
from rigidfluid.studies.model import Settings
from rigidfluid.studies.results import Results
from rigidfluid.studies.rows import text_of

_MARKERS = "osD^vP*X"


def error_plot(results: Results) -> Figure:
    """A line for each value of the group, and the Pareto front behind them.

    Parameters
    ----------
    results : Results
        With at least one point.

    Returns
    -------
    Figure
        One panel.
    """
    figure = new_figure(8.0, 5.0)
    axes = figure.subplots()
    _draw_front(axes, results)
    for (name, keys), colour, marker in zip(_series(results).items(), cycle(PALETTE), cycle(_MARKERS)):
        axes.plot(*_coordinates(results, keys), marker=marker, color=colour, linewidth=1.0, label=name)
    _name_front(axes, results)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.1)
    axes.set_xlabel("wall time [s]")
    axes.set_ylabel(error_label(results))
    axes.grid(which="minor", alpha=0.12)
    figure.legend(loc="outside upper center", ncols=4)
    return figure


def error_label(results: Results) -> str:
    """What the error is of, and against what."""
    tables = results.study.tables
    what = tables.study.label or str(tables.error.figure)
    against = "the finest run" if tables.error.reference is None else f"{tables.error.reference:g}"
    return f"{'relative error' if results.is_relative else 'error'} of {what}\nagainst {against}"


def _series(results: Results) -> dict[str, list[str]]:
    """Fingerprints of the points by value of the group, each by wall time."""
    group = results.study.tables.study.group
    series: dict[str, list[str]] = {}
    for key, settings in sorted(_settings(results).items(), key=lambda item: results.points[item[0]]):
        name = "runs" if group is None else f"{group} = {text_of(settings[group])}"
        series.setdefault(name, []).append(key)
    return dict(sorted(series.items(), key=lambda item: _place(results, item[1][0])))


def _settings(results: Results) -> dict[str, Settings]:
    return {key: settings for key, settings in zip(results.prints, results.plan, strict=True) if key in results.points}


def _place(results: Results, key: str) -> int:
    """Where the value of the group stands in its list."""
    group = results.study.tables.study.group
    return 0 if group is None else results.study.tables.vary[group].index(_settings(results)[key][group])


def _coordinates(results: Results, keys: list[str]) -> tuple[list[float], list[float]]:
    return [results.points[key][0] for key in keys], [results.points[key][1] for key in keys]


def _draw_front(axes: Axes, results: Results) -> None:
    seconds, errors = _coordinates(results, results.front)
    axes.plot(seconds, errors, drawstyle="steps-post", color=BLACK, alpha=0.15, linewidth=6.0, zorder=0)
    axes.plot(seconds, errors, "o", color=BLACK, markersize=13, fillstyle="none", label="Pareto front", zorder=0)


def _name_front(axes: Axes, results: Results) -> None:
    """Write the knobs of the front's runs beside them, but for the group, which the colour tells."""
    shown = [key for key in results.study.knobs if key != results.study.tables.study.group]
    settings = _settings(results)
    for key in results.front:
        words = "\n".join(f"{knob.rpartition('.')[2]} {text_of(settings[key][knob])}" for knob in shown)
        axes.annotate(words, results.points[key], (9, 7), textcoords="offset points", fontsize=8)
