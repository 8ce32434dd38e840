"""A picture of a scene for the gallery, from the folder of its run: all have one size and the colours of a report."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rigidfluid.post.reports.moment import Moment, moment
from rigidfluid.post.reports.paths import draw_paths
from rigidfluid.post.reports.pictures import flow_picture, mesh_picture, streamline_picture
from rigidfluid.post.reports.results import Results, read_results
from rigidfluid.post.reports.scale import Quantity, Scale
from rigidfluid.post.reports.shared_scale import shared_scale
from rigidfluid.post.reports.space import flow_space_picture
from rigidfluid.post.reports.style import STYLE, new_figure
from rigidfluid.post.reports.view_plane import PlaneName, ViewPlane, view_plane

WIDTH, HEIGHT = 4.4, 3.0
"""Of all pictures [inch]."""

View = Quantity | Literal["streamlines", "mesh", "space", "paths"]


@dataclass(frozen=True)
class Shown:
    """A ``view`` of a run at ``times`` [time], for which the run needs ``settings`` besides its scene's.

    ``window``: left, lower, right and upper end of what is seen about the first body [length]; all if not given.
    ``plane``: of a 3D run, as `view_plane` takes it.
    """

    view: View
    times: tuple[float, ...]
    window: tuple[float, float, float, float] | None = None
    plane: PlaneName = "motion"
    settings: tuple[str, ...] = ()


def scene_picture(folder: Path, shown: Shown) -> Figure:
    """Draw what is ``shown`` of the run in a folder."""
    results = read_results(folder, motion_only=True)
    plane = view_plane(results, shown.plane)
    with matplotlib.rc_context(STYLE):
        figure = _paths(results, plane) if shown.view == "paths" else _flow(results, plane, shown)
    figure.set_size_inches(WIDTH, HEIGHT)
    figure.set_layout_engine("compressed")
    return results.units.put_into_labels(figure)


def _paths(results: Results, plane: ViewPlane) -> Figure:
    figure = new_figure(WIDTH, HEIGHT)
    axes = figure.add_subplot()
    draw_paths(axes, results, plane)
    axes.set_axis_off()
    return figure


def _flow(results: Results, plane: ViewPlane, shown: Shown) -> Figure:
    scale = shared_scale(results, shown.view if shown.view in get_args(Quantity) else "speed", plane, None)
    outputs = np.array([time for time, _ in results.series])
    moments = [moment(results, int(np.argmin(np.abs(outputs - time))), plane, 0) for time in shown.times]
    figure = _panels(results, plane, moments, scale, shown.view)
    for axes, now in zip(figure.axes, moments, strict=False):
        _make_plain(axes)
        if shown.window is not None:
            left, lower, right, upper = shown.window
            axes.set(xlim=now.centre[0] + [left, right], ylim=now.centre[1] + [lower, upper])
    return figure


def _make_plain(axes: Axes) -> None:
    """Leave out ticks, and names of axes and of edges: a card of the gallery is small."""
    axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
    axes.spines[:].set_visible(True)
    for text in tuple(axes.texts):
        text.remove()


def _panels(results: Results, plane: ViewPlane, moments: list[Moment], scale: Scale, view: View) -> Figure:
    match view:
        case "streamlines":
            return streamline_picture(moments, scale)
        case "mesh":
            return mesh_picture(moments, scale)
        case "space":
            return flow_space_picture(results, moments, plane, scale)
    return flow_picture(moments, scale)
