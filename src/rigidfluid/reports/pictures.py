"""Pictures of a 2D flow: the speed in the whole domain, the mesh about one body, and its narrowest gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import TriMesh
from matplotlib.figure import Figure

from rigidfluid.core.model.types import BoolArray, Fields, FloatArray
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.reports.plane import Outline, corner_triangles, fine_triangles
from rigidfluid.reports.results import Results
from rigidfluid.reports.style import BODY, COLOURMAP, new_figure

MOMENTS = 4
"""How many output times a row of pictures shows."""


@dataclass(frozen=True)
class Moment:
    """The fields at one output time, and the centre (2,) of the body looked at."""

    time: float
    fields: Fields
    centre: FloatArray
    gap: float

    @property
    def speed(self) -> FloatArray:
        """|u| at the nodes, (N,) [length/time]."""
        return np.asarray(np.linalg.norm(self.fields.velocity, axis=1))


@dataclass(frozen=True)
class View:
    """The part of the plane that a panel shows, between the corners ``lower`` and ``upper`` (2,), with mesh or not."""

    lower: FloatArray
    upper: FloatArray
    mesh: bool

    @classmethod
    def about(cls, centre: FloatArray, half: float) -> View:
        """A square about a point, with the mesh."""
        return cls(centre - half, centre + half, mesh=True)

    def holds(self, points: FloatArray) -> BoolArray:
        """Which points (N, 2) lie in the view, (N,)."""
        return np.asarray(np.all((points >= self.lower) & (points <= self.upper), axis=1))


def moments(results: Results) -> list[Moment]:
    """Some output times spread over the run, the last among them, looking at the body that came nearest to anything."""
    count = len(results.series)
    chosen = np.unique(np.linspace(0, count - 1, min(MOMENTS + 1, count)).round().astype(int))
    body = int(np.argmin(results.bodies["gap"].min(axis=0)))
    return [_moment(results, int(i), body) for i in (chosen[1:] if count > 1 else chosen)]


def narrowest_moment(results: Results) -> Moment:
    """The output time at which a gap was smallest, looking at that body."""
    gaps = np.array([results.bodies["gap"][_state(results, time)] for time, _ in results.series])
    output, body = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
    return _moment(results, int(output), int(body))


def speed_picture(shown: Sequence[Moment]) -> Figure:
    """Speed in the whole domain."""
    return _panels(shown, [View(*_corners(moment), mesh=False) for moment in shown])


def mesh_picture(shown: Sequence[Moment]) -> Figure:
    """Speed and mesh about one body."""
    return _panels(shown, [View.about(moment.centre, 1.5 * _extent(moment)) for moment in shown])


def gap_picture(moment: Moment) -> Figure:
    """Close-up of the narrowest gap with its cells."""
    middle = Outline.of(moment.fields).narrowest(moment.centre)
    return _panels([moment], [View.about(middle, min(4.0 * moment.gap, _extent(moment)))])


def _panels(shown: Sequence[Moment], views: Sequence[View]) -> Figure:
    """One panel a moment, solids grey, the same colours for the same speed in all."""
    figure, panels = _frame(len(shown), views[0])
    fastest = max(
        float(m.speed[view.holds(m.fields.points)].max(initial=0.0)) for m, view in zip(shown, views, strict=True)
    )
    for axes, moment, view in zip(panels, shown, views, strict=True):
        colours = _draw(axes, moment, view, fastest)
    figure.colorbar(colours, ax=panels, label="speed [length/time]", shrink=0.8)
    return figure


def _frame(count: int, view: View) -> tuple[Figure, list[Axes]]:
    """Panels in a row for a tall view, in a column for a flat one, else two by two."""
    width, height = view.upper - view.lower
    columns = min(count, 4 if height > 1.5 * width else 2 if height > 0.8 * width else 1)
    rows = -(-count // columns)
    panel_width = 7.2 / max(columns, 1.5)
    figure = new_figure(columns * panel_width + 2.0, rows * (panel_width * height / width + 0.5) + 0.3)
    grid = figure.subplots(rows, columns, squeeze=False)
    for unused in grid.ravel()[count:]:
        unused.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel("x [length]")
    for row in grid:
        row[0].set_ylabel("y [length]")
    return figure, list(grid.ravel()[:count])


def _draw(axes: Axes, moment: Moment, view: View, fastest: float) -> TriMesh:
    axes.set_facecolor(BODY)
    axes.grid(visible=False)
    colours = axes.tripcolor(
        fine_triangles(moment.fields), moment.speed, shading="gouraud", cmap=COLOURMAP, vmin=0.0, vmax=fastest or 1.0
    )
    if view.mesh:
        axes.triplot(corner_triangles(moment.fields), color="white", linewidth=0.3)
    axes.set_aspect("equal")
    axes.set_xlim(view.lower[0], view.upper[0])
    axes.set_ylim(view.lower[1], view.upper[1])
    axes.locator_params(nbins=4)
    axes.set_title(f"time {moment.time:.4g}" + (f", gap {moment.gap:.3g}" if view.mesh else ""))
    return colours


def _corners(moment: Moment) -> tuple[FloatArray, FloatArray]:
    points = moment.fields.points
    return points.min(axis=0), points.max(axis=0)


def _extent(moment: Moment) -> float:
    """The body's largest width."""
    return float(np.ptp(Outline.of(moment.fields).around(moment.centre), axis=0).max())


def _moment(results: Results, output: int, body: int) -> Moment:
    time, path = results.series[output]
    state = _state(results, time)
    return Moment(time, read_vtu(path), results.vectors("")[state, body], float(results.bodies["gap"][state, body]))


def _state(results: Results, time: float) -> int:
    """Number of the accepted state at an output time."""
    return int(np.argmin(np.abs(results.time - time)))
