"""Pictures of a 2D flow: speed, vorticity, streamlines and mesh in the whole domain; mesh about one body; its gap."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from rigidfluid.core.model.types import BoolArray, Fields, FloatArray
from rigidfluid.core.output.vtu import read_vtu
from rigidfluid.reports.flow import vorticity
from rigidfluid.reports.plane import Outline, cell_by_cell, corner_triangles, fine_triangles
from rigidfluid.reports.raster import Grid, Sampling
from rigidfluid.reports.results import Results
from rigidfluid.reports.style import BODY, COLOURMAP, SIGNED_COLOURMAP, new_figure

MOMENTS = 4
"""How many output times a row of pictures shows."""

SHARE = 99.0
"""Per cent of the nodes whose vorticity has a colour of its own: at one sharp corner it is without bound."""

TALLEST, NARROWEST = 8.0, 1.4
"""A panel's greatest height, and the least width of its place [inch]."""

_GRID = 400  # points along the longer side from which streamlines are drawn
_CALM = 1e-4  # of the highest speed: where the fluid is slower, rounding decides where it goes


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
    """The part of the plane that a panel shows, between the corners ``lower`` and ``upper`` (2,)."""

    lower: FloatArray
    upper: FloatArray

    @classmethod
    def about(cls, centre: FloatArray, half: float) -> View:
        """A square about a point."""
        return cls(centre - half, centre + half)

    @classmethod
    def whole(cls, moment: Moment) -> View:
        """All that is meshed."""
        points = moment.fields.points
        return cls(points.min(axis=0), points.max(axis=0))

    def holds(self, points: FloatArray) -> BoolArray:
        """Which points (N, 2) lie in the view, (N,)."""
        return np.asarray(np.all((points >= self.lower) & (points <= self.upper), axis=1))


@dataclass(frozen=True)
class Colours:
    """What colours show: a ``label``, a ``map``, the range ``lowest`` to ``highest``, and how a moment is coloured:
    triangles and values at their corners."""

    label: str
    map: str
    lowest: float
    highest: float
    of: Callable[[Moment], tuple[Triangulation, FloatArray]]


Over = Callable[[Axes, Moment, View], object]
"""What is drawn over the colours."""


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
    views = [View.whole(moment) for moment in shown]
    return _panels(shown, views, _speed(shown, views))


def streamline_picture(shown: Sequence[Moment]) -> Figure:
    """Streamlines over the speed, seen by an observer at rest."""
    views = [View.whole(moment) for moment in shown]
    return _panels(shown, views, _speed(shown, views), _draw_streamlines)


def vorticity_picture(shown: Sequence[Moment]) -> Figure:
    """Vorticity in the whole domain."""
    views = [View.whole(moment) for moment in shown]
    size = np.concatenate([np.abs(vorticity(moment.fields)).ravel() for moment in shown])
    highest = float(np.percentile(size, SHARE))
    colours = Colours("vorticity [1/time]", SIGNED_COLOURMAP, -highest, highest, _vorticity_of)
    return _panels(shown, views, colours)


def whole_mesh_picture(moment: Moment) -> Figure:
    """All cells."""
    view = View.whole(moment)
    return _panels([moment], [view], _speed([moment], [view]), _draw_mesh)


def mesh_picture(shown: Sequence[Moment]) -> Figure:
    """Speed and mesh about one body."""
    return _mesh_panels(shown, [View.about(moment.centre, 1.5 * _extent(moment)) for moment in shown])


def gap_picture(moment: Moment) -> Figure:
    """Close-up of the narrowest gap with its cells."""
    middle = Outline.of(moment.fields).narrowest(moment.centre)
    return _mesh_panels([moment], [View.about(middle, min(4.0 * moment.gap, _extent(moment)))])


def _mesh_panels(shown: Sequence[Moment], views: Sequence[View]) -> Figure:
    figure = _panels(shown, views, _speed(shown, views), _draw_mesh)
    for axes, moment in zip(figure.axes, shown, strict=False):
        axes.set_title(f"time {moment.time:.4g}, gap {moment.gap:.3g}")
    return figure


def _panels(shown: Sequence[Moment], views: Sequence[View], colours: Colours, over: Over | None = None) -> Figure:
    """One panel a moment, solids grey, the same colours for the same value in all."""
    figure, panels = _frame(len(shown), views[0])
    for axes, moment, view in zip(panels, shown, views, strict=True):
        drawn = axes.tripcolor(
            *colours.of(moment), shading="gouraud", cmap=colours.map, vmin=colours.lowest, vmax=colours.highest or 1.0
        )
        if over is not None:
            over(axes, moment, view)
        _look_at(axes, view)
        axes.set_title(f"time {moment.time:.4g}")
    extend = "both" if colours.lowest < 0.0 else "neither"
    figure.colorbar(drawn, ax=panels, label=colours.label, shrink=0.8, extend=extend)
    return figure


def _frame(count: int, view: View) -> tuple[Figure, list[Axes]]:
    """Panels in a row for a tall view, in a column for a flat one, else two by two; low enough for a page."""
    width, height = view.upper - view.lower
    columns = min(count, 4 if height > 1.5 * width else 2 if height > 0.8 * width else 1)
    rows = -(-count // columns)
    panel_width = min(7.2 / max(columns, 1.5), TALLEST * width / height)
    place = max(panel_width, NARROWEST)
    figure = new_figure(columns * place + 2.0, rows * (panel_width * height / width + 0.5) + 0.3)
    grid = figure.subplots(rows, columns, squeeze=False)
    for unused in grid.ravel()[count:]:
        unused.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel("x [length]")
    for row in grid:
        row[0].set_ylabel("y [length]")
    return figure, list(grid.ravel()[:count])


def _look_at(axes: Axes, view: View) -> None:
    axes.set_facecolor(BODY)
    axes.grid(visible=False)
    axes.set_aspect("equal")
    axes.set_xlim(view.lower[0], view.upper[0])
    axes.set_ylim(view.lower[1], view.upper[1])
    width, height = view.upper - view.lower
    axes.locator_params(axis="x", nbins=4 if height < 4.0 * width else 1)
    axes.locator_params(axis="y", nbins=4 if width < 4.0 * height else 2)


def _speed(shown: Sequence[Moment], views: Sequence[View]) -> Colours:
    """From rest to the highest speed that is seen."""
    seen = [m.speed[view.holds(m.fields.points)] for m, view in zip(shown, views, strict=True)]
    fastest = max(float(values.max(initial=0.0)) for values in seen)
    return Colours(
        "speed [length/time]", COLOURMAP, 0.0, fastest, lambda moment: (fine_triangles(moment.fields), moment.speed)
    )


def _vorticity_of(moment: Moment) -> tuple[Triangulation, FloatArray]:
    """It jumps from cell to cell, so each cell has corners of its own."""
    return cell_by_cell(moment.fields), vorticity(moment.fields).ravel()


def _draw_mesh(axes: Axes, moment: Moment, view: View) -> None:
    axes.triplot(corner_triangles(moment.fields), color="white", linewidth=0.3)


def _draw_streamlines(axes: Axes, moment: Moment, view: View) -> None:
    """Lines along the velocity, none where the fluid rests to rounding."""
    grid = Grid.between(view.lower, view.upper, _GRID)
    sampling = Sampling.of(moment.fields, grid)
    u, v = (sampling.image(moment.fields.velocity[:, k][moment.fields.cells]) for k in range(2))
    moving = np.hypot(u, v) > _CALM * moment.speed.max()  # False outside the mesh
    if not moving.any():
        return
    x = grid.origin[0] + grid.right[0] * np.arange(grid.columns)
    y = grid.origin[1] + grid.up[1] * np.arange(grid.rows)
    size = view.upper - view.lower
    u, v = (np.ma.masked_where(~moving, values) for values in (u, v))
    density = tuple(np.maximum(1.5 * size / size.max(), 0.25))
    axes.streamplot(x, y, u, v, density=density, color="white", linewidth=0.6, arrowsize=0.6)


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
