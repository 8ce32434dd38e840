"""Progress of a run in a notebook: a bar, and a plot of one column of the tables that grows."""

from __future__ import annotations

import base64
import io
import time
from html import escape
from typing import Any

import matplotlib
import numpy as np

from rigidfluid.core.output.history import History
from rigidfluid.core.output.optional_package import optional_package
from rigidfluid.core.output.tables import KINDS
from rigidfluid.core.run.run import Progress
from rigidfluid.errors import ArgumentError, OutputError
from rigidfluid.post.reports.style import PALETTE, STYLE, new_figure

_ROW_NAMES = ("body", "joint", "probe")
"""Columns that say which body, joint or probe a row is of: each has a line of its own."""
_DRAWING_SHARE = 0.1
"""Most of the time that drawing may take."""


class NotebookProgress:
    """Show in a notebook how far a run is, in its place and anew: ``run(scene, progress=NotebookProgress())``.

    Parameters
    ----------
    plot : str, optional
        Table and column that are drawn over time below the bar, as ``bodies.vy``, with a line for each of the first
        seven bodies, joints or probes; no plot if not given.
    every : float
        Seconds from one picture to the next; more where drawing would take a tenth of the time.

    Raises
    ------
    OutputError
        If no notebook or IPython runs this.
    """

    def __init__(self, plot: str | None = None, every: float = 1.0) -> None:
        shell = optional_package("IPython", "notebooks")
        if shell.get_ipython() is None:
            remedy = "Give run another progress=…, a function of its own kind."
            raise OutputError("NotebookProgress", "a program without IPython", "a notebook", remedy)
        self._show = shell.display.display
        self._plot, self._every, self._due = plot, every, 0.0
        self._handle: Any = None
        self._history: History | None = None

    def __call__(self, now: Progress) -> None:
        if now.history is not self._history:  # another run has a place of its own
            self._history, self._handle, self._due = now.history, None, 0.0
        if now.elapsed < self._due and now.time + 0.5 * now.step < now.end:
            return
        start = time.perf_counter()
        shown = {"text/html": page(now, self._plot), "text/plain": words(now)}
        if self._handle is None:
            self._handle = self._show(shown, raw=True, display_id=True)
        else:
            self._handle.update(shown, raw=True)
        self._due = now.elapsed + max(self._every, (time.perf_counter() - start) / _DRAWING_SHARE)


def words(now: Progress) -> str:
    """Progress in one line."""
    failed = f", {now.failed_remeshes} failed re-meshes" if now.failed_remeshes else ""
    return f"time {now.time:.4g} of {now.end:.4g}, step {now.step:.3g}, gap {now.gap:.3g}{failed}, {now.elapsed:.0f} s"


def page(now: Progress, plot: str | None) -> str:
    """HTML of a bar, with a picture of the column ``plot`` below it; raises ArgumentError where there is none such."""
    bar = f"<progress value='{now.time:.6g}' max='{now.end:.6g}'></progress> {escape(words(now))}"
    if plot is None:
        return bar
    image = base64.b64encode(picture(now.history, plot, now.end)).decode("ascii")
    return f"{bar}<br><img alt='{escape(plot)} over time' src='data:image/png;base64,{image}'>"


def picture(history: History, plot: str, end: float) -> bytes:
    """PNG of a column over time, a line for each body, joint or probe; raises ArgumentError where there is none."""
    table, _, column = plot.partition(".")
    known = history.columns.get(table, ())
    if column not in known or KINDS.get(column) is str:
        names = [name for name in known if KINDS.get(name) is not str]
        allowed = f"a column of numbers of {table}: {', '.join(names)}" if names else "table.column, as bodies.vy"
        raise ArgumentError("plot", repr(plot), allowed, "Name one that the run has.")
    group = [name for name in _ROW_NAMES if name in known]
    found = history.table(table, ("time", column, *group))
    with matplotlib.rc_context(STYLE):
        figure = new_figure(6.0, 2.4)
        axes = figure.add_subplot(xlabel="time [time]", ylabel=plot, xlim=(0.0, end))
        rows = found[group[0]] if group else np.full(len(found["time"]), column)
        for name, colour in zip(dict.fromkeys(rows.tolist()), PALETTE, strict=False):
            one, form = rows == name, "." if table == "contacts" else "-"
            axes.plot(found["time"][one], found[column][one], form, color=colour, label=str(name))
        if len(rows):
            axes.legend()
        data = io.BytesIO()
        figure.savefig(data, format="png")
    return data.getvalue()
