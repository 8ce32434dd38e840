"""Values of many bodies over time in one panel: a line each while they can be told apart, else their spread."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.style import BLUE, PALETTE

_PER_LETTER, _LETTERS_OF_HANDLE = 0.068, 8
"""Mean width of a letter in a legend [inch], and how many a line's sample and the room around it are wide."""

MOST_LINES = len(PALETTE)
"""More bodies than this are shown by their spread."""


def draw_bodies(axes: Axes, time: FloatArray, values: FloatArray, names: Sequence[str]) -> None:
    """Draw ``values`` (s, n) over ``time`` (s,); values that are not finite leave a hole."""
    finite = np.where(np.isfinite(values), values, np.nan)
    if len(names) > MOST_LINES:
        _draw_spread(axes, time, finite, len(names))
        return
    for curve, name, colour in zip(finite.T, names, PALETTE, strict=False):
        axes.plot(time, curve, color=colour, label=escape_dollars(name))


def add_legend(figure: Figure | SubFigure) -> None:
    """A legend above all panels, where there is more than one thing to name."""
    named: dict[str, Artist] = {}
    for axes in figure.axes:
        handles, labels = axes.get_legend_handles_labels()
        named.update(zip(labels, handles, strict=True))
    if len(named) > 1:
        figure.legend(list(named.values()), list(named), loc="outside upper center", ncols=_columns(figure, named))


def _columns(figure: Figure | SubFigure, names: Iterable[str]) -> int:
    """Columns of a legend, at most five, of which the figure has room for so many as wide as the longest name."""
    widest = _PER_LETTER * (max(map(len, names)) + _LETTERS_OF_HANDLE)
    return int(np.clip(figure.bbox.width / figure.figure.dpi // widest, 1, 5))


def widen(axes: Axes, least: float) -> None:
    """Show at least this span, so that a drift of nothing looks like nothing."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def _draw_spread(axes: Axes, time: FloatArray, values: FloatArray, count: int) -> None:
    """Median, the middle 90 % and the extremes of those bodies that have a value at each time."""
    known = np.isfinite(values).any(axis=1)
    low, five, half, most, high = np.full((5, len(time)), np.nan)
    if known.any():
        low[known], five[known], half[known], most[known], high[known] = np.nanpercentile(
            values[known], (0, 5, 50, 95, 100), axis=1
        )
    axes.fill_between(time, low, high, color=BLUE, alpha=0.15, linewidth=0, label=f"all {count} bodies")
    axes.fill_between(time, five, most, color=BLUE, alpha=0.35, linewidth=0, label="middle 90 %")
    axes.plot(time, half, color=BLUE, label="median")


def escape_dollars(name: str) -> str:
    """Escape dollars in a name, which enclose no formula."""
    return name.replace("$", r"\$")
