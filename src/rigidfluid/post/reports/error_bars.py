"""Error bars of a run with ``output.error_bars``: on curves over time, and in a table of the last output."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.error_figures import error_bars
from rigidfluid.core.output.history import History
from rigidfluid.core.output.records import CAUSES, ESTIMATED, quantity_columns
from rigidfluid.post.reports.curves import MOST_LINES
from rigidfluid.post.reports.html import grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import PALETTE

_UNITS = {
    "velocity": "[length/time]",
    "angular_velocity": "[rad/time]",
    "force": "[force]",
    "torque": "[force·length]",
}


class Bars(NamedTuple):
    """Estimated errors of a ``quantity`` of all bodies at outputs: numbers of their ``states`` (o,), and magnitudes
    ``by_mesh`` and ``by_steps`` of each component (o, n, c)."""

    states: tuple[int, ...]
    by_mesh: FloatArray
    by_steps: FloatArray

    @property
    def bar(self) -> FloatArray:
        """Error bars (o, n, c)."""
        return error_bars(self.by_mesh, self.by_steps)


def bars(results: Results, quantity: str) -> Bars | None:
    """Error bars of a quantity; None where the run has none."""
    if not results.model.output.error_bars:
        return None
    table = History(results.system.dimension, folder=results.folder).error_estimates
    of_bodies = np.isin(table["body"], results.names)
    times = np.unique(table["time"][of_bodies])
    if not len(times) or of_bodies.sum() != len(times) * len(results.names):
        return None  # bodies have entered or left
    columns = quantity_columns(results.system.dimension)[quantity]
    by_mesh, by_steps = (
        np.abs(np.stack([table[f"{name}_{cause}"][of_bodies].reshape(len(times), -1) for name in columns], axis=-1))
        for cause in CAUSES
    )
    return Bars(tuple(map(results.state_at, times.tolist())), by_mesh, by_steps)


def draw_bars(axes: Axes, results: Results, quantity: str, component: int | None = None) -> None:
    """Draw error bars of one ``component`` of a quantity, or of its magnitude, on the curves of few bodies."""
    found = bars(results, quantity)
    if found is None or len(results.names) > MOST_LINES:
        return
    values, errors = results.quantity(quantity)[list(found.states)], found.bar
    if component is None:
        values, errors = (np.asarray(np.linalg.norm(each, axis=-1)) for each in (values, errors))
    else:
        values, errors = values[..., component], errors[..., component]
    time = results.time[list(found.states)]
    for value, error, colour in zip(values.T, errors.T, PALETTE, strict=False):
        axes.errorbar(time, value, error, fmt="none", ecolor=colour, capsize=2.0, linewidth=0.8)


def error_table(results: Results, most: int) -> Iterator[str]:
    """A table of the last output, of the first ``most`` bodies: each value with its errors by mesh and by steps."""
    rows, time = [], 0.0
    for quantity in ESTIMATED:
        found = bars(results, quantity)
        if found is None:
            return
        state, values = found.states[-1], results.quantity(quantity)
        time = float(results.time[state])
        names = quantity_columns(results.system.dimension)[quantity]
        for body, k in np.ndindex(min(len(results.names), most), len(names)):
            errors = (float(each[-1, body, k]) for each in (found.bar, found.by_mesh, found.by_steps))
            rows.append((results.names[body], f"{names[k]} {_UNITS[quantity]}", float(values[state, body, k]), *errors))
    yield "<h2>Error bars</h2>"
    yield f"<p>At {time:.5g} [time]; in all outputs they are in error_estimates.csv.</p>"
    yield grid(("body", "quantity", "value", "error bar", "error by the mesh", "error by the steps"), rows)
