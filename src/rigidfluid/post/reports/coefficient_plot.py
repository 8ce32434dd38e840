"""The plot of drag and lift coefficients over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.coefficients import Reference, coefficients
from rigidfluid.post.reports.curves import add_legend, draw_bodies
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import time_panels

_NAMES = ("drag coefficient", "lift coefficient", "side coefficient")


def coefficient_plot(results: Results, by: Reference) -> Figure:
    """Drag along the flow, and lift across it; bursts as in impacts and sudden starts may go beyond the panels."""
    found = coefficients(results, by)
    figure, panels = time_panels(found.shape[2])
    for k, axes in enumerate(panels):
        draw_bodies(axes, results.time, found[..., k], results.names)
        axes.set_ylabel(_NAMES[k])
        _show_most(axes, found[1:, :, k])
    add_legend(figure)
    return figure


def coefficient_caption(by: Reference, dimension: int) -> str:
    """Caption with the reference velocity, area and direction of the coefficients."""
    area = "D" if dimension == 2 else "πD²/4"
    direction = ", ".join(f"{part:.3g}" for part in by.axes[0] + 0.0)
    return (
        f"Force of the fluid over ½ρU²{area}, along ({direction}) and across it: U = {by.speed:.4g} is {by.words}, "
        "D the diameter of the ball with the body's volume."
    )


def _show_most(axes: Axes, values: FloatArray) -> None:
    """Limits that leave out the most extreme per cent at either end, where those are much further away."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return
    low, high = np.percentile(finite, (1, 99))
    room = 0.5 * max(high - low, 1e-3 * max(abs(low), abs(high)))
    bottom, top = axes.get_ylim()
    axes.set_ylim(max(bottom, low - room), min(top, high + room))
