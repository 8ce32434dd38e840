"""Lines of a plot by the settings of their runs, and the words for these."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import cycle

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

from rigidfluid.post.reports.curves import escape_dollars
from rigidfluid.post.reports.style import BLACK, PALETTE
from rigidfluid.post.studies.results import Results
from rigidfluid.post.studies.rows import short_text
from rigidfluid.post.studies.strict_table import Settings

_MARKERS = "osD^vP*X"

WIDE = 10.0
"""Ratio of positive values from which on their axis is logarithmic."""

Lines = Mapping[tuple[str, ...], Sequence[tuple[float, float]]]
"""Points of each line, by its name of one or two parts."""


def draw_lines(axes: Axes, lines: Lines) -> list[Artist]:
    """Draw the lines, the first part of a name gives the colour, the last one the marker; return the artists that stand
    for them in the legend."""
    colours = dict(zip(dict.fromkeys(name[0] for name in lines), cycle(PALETTE)))
    markers = dict(zip(dict.fromkeys(name[-1] for name in lines), cycle(_MARKERS)))
    drawn: list[Artist] = []
    for name, points in lines.items():
        colour, marker = colours[name[0]], markers[name[-1]]
        drawn += axes.plot(*zip(*points, strict=True), color=colour, marker=marker, linewidth=1.0, label=name[0])
    if all(len(name) < 2 for name in lines):
        return drawn
    named: list[Artist] = [Line2D([], [], color=colour, label=word) for word, colour in colours.items()]
    for word, marker in markers.items():
        named.append(Line2D([], [], color=BLACK, marker=marker, linestyle="none", label=word))
    return named


def scale_axis(axes: Axes, values: Sequence[float]) -> None:
    """Make the axis of a parameter logarithmic where its values are far apart."""
    if min(values) > 0.0 and max(values) >= WIDE * min(values):
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
    else:
        axes.locator_params(axis="x", nbins=5)


def knob_words(results: Results, knob: str, settings: Settings) -> str:
    """A setting in few words; also of runs that do not read it."""
    short = knob.rpartition(".")[2]
    if knob not in settings:
        return f"without {short}"
    value = settings[knob]
    text = short_text(value, results.study.values(knob))
    return escape_dollars(text if isinstance(value, dict) else f"{short} {text}")


def settings_words(results: Results, knobs: Iterable[str], settings: Settings) -> str:
    """Several settings in one line."""
    return ", ".join(knob_words(results, knob, settings) for knob in knobs)
