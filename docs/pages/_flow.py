"""Pictures of the vorticity at some moments, beside each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from page_tools import Run

from rigidfluid.core.output.cell_gradients import vorticity
from rigidfluid.core.output.vtu import read_pvd, read_vtu
from rigidfluid.post.reports.plane import cell_by_cell
from rigidfluid.post.reports.scale import SIGNED_COLOURMAP
from rigidfluid.post.reports.style import BODY


def vorticity_pictures(run: Run, moments: Sequence[float], height: float, scale: float) -> Figure:
    """Vorticity in a part of the domain, ``height`` high, about the bodies; colours go up to ``scale``."""
    series = dict(read_pvd(run.folder / "fields.pvd"))
    panel = 8.0 / len(moments)
    figure = Figure(figsize=(8.0, panel * height / _width(run) + 1.3), dpi=120, layout="constrained")
    for axes, moment in zip(figure.subplots(1, len(moments)), moments, strict=True):
        time = min(series, key=lambda at: abs(at - moment))
        fields = read_vtu(series[time])
        triangles, values = cell_by_cell(fields), vorticity(fields).ravel()
        colours = axes.tripcolor(
            triangles, values, shading="gouraud", cmap=SIGNED_COLOURMAP, vmin=-scale, vmax=scale, rasterized=True
        )
        middle = _mean_height(run, time)
        axes.set(
            xlim=(triangles.x.min(), triangles.x.max()), ylim=(middle - height / 2, middle + height / 2),
            title=f"{time:.3g} s", facecolor=BODY, aspect="equal", xticks=[],
        )  # fmt: skip
    figure.colorbar(colours, ax=figure.axes, location="bottom", label="vorticity [1/s]", shrink=0.5, aspect=40)
    return figure


def _width(run: Run) -> float:
    domain = run.summary["scene"]["domain"]
    return float(domain["upper"][0] - domain["lower"][0])


def _mean_height(run: Run, time: float) -> float:
    bodies = run.history.bodies
    now = bodies["time"] == bodies["time"][np.argmin(np.abs(bodies["time"] - time))]
    return float(bodies["y"][now].mean())
