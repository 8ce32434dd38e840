"""Pictures of a flow, in 3D of a slice of it: speed, pressure, vorticity, streamlines and mesh; mesh about one body."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from rigidfluid.core.model.types import FloatArray
from rigidfluid.post.reports.moment import Moment, View
from rigidfluid.post.reports.raster import Grid, Sampling
from rigidfluid.post.reports.style import BLACK, BODY, COLOURMAP, SIGNED_COLOURMAP, new_figure

SHARE = 99.0
"""Per cent of the nodes whose vorticity or pressure has a colour of its own: at one sharp corner both are without
bound."""

TALLEST, NARROWEST = 8.0, 1.4
"""A panel's greatest height, and the least width of its place [inch]."""

_GRID = 400  # points along the longer side from which streamlines are drawn
_CALM = 1e-4  # of the highest speed: where the fluid is slower, rounding decides where it goes
_OUT_OF_PLANE = 45.0  # degrees between velocity and slice from which on a line in the slice tells little


@dataclass(frozen=True)
class Colours:
    """Colours of a picture: a ``label``, a ``map``, the range ``lowest`` to ``highest``, and the ``values`` of a moment
    at its nodes (N,), or at those of each cell (M, b)."""

    label: str
    map: str
    lowest: float
    highest: float
    values: Callable[[Moment], FloatArray]


Over = Callable[[Axes, Moment, View], object]
"""Function that draws over the colours."""


def speed_picture(shown: Sequence[Moment]) -> Figure:
    """Speed in the whole domain."""
    views = [View.whole(moment) for moment in shown]
    return _panels(shown, views, _speed(shown, views))


def streamline_picture(shown: Sequence[Moment]) -> Figure:
    """Streamlines over the speed, seen by an observer at rest."""
    views = [View.whole(moment) for moment in shown]
    return _panels(shown, views, _speed(shown, views), _draw_streamlines)


def vorticity_picture(shown: Sequence[Moment]) -> Figure:
    """Vorticity in the whole domain, of a slice the component to the observer."""
    return _signed_picture(shown, "vorticity [1/time]", lambda moment: moment.section.vorticity)


def pressure_picture(shown: Sequence[Moment]) -> Figure:
    """Dynamic pressure in the whole domain."""
    unit = "force/area" if shown[0].section.is_slice else "force/length"
    return _signed_picture(shown, f"pressure [{unit}]", lambda moment: moment.section.fields.pressure)


def whole_mesh_picture(moment: Moment) -> Figure:
    """All cells."""
    view = View.whole(moment)
    return _panels([moment], [view], _speed([moment], [view]), _draw_mesh)


def mesh_picture(shown: Sequence[Moment]) -> Figure:
    """Speed and mesh about one body."""
    return _mesh_panels(shown, [View.about(moment.centre, 1.5 * moment.width) for moment in shown])


def gap_picture(moment: Moment, middle: FloatArray) -> Figure:
    """Close-up of a gap about its ``middle`` (2,), with its cells."""
    return _mesh_panels([moment], [View.about(middle, min(4.0 * moment.gap, moment.width))])


def _mesh_panels(shown: Sequence[Moment], views: Sequence[View]) -> Figure:
    figure = _panels(shown, views, _speed(shown, views), _draw_mesh)
    for axes, moment in zip(figure.axes, shown, strict=False):
        axes.set_title(f"time {moment.time:.4g}, gap {moment.gap:.3g}")
    return figure


def _panels(shown: Sequence[Moment], views: Sequence[View], colours: Colours, over: Over | None = None) -> Figure:
    """One panel a moment, solids grey, the same colours for the same value in all."""
    figure, panels = frame(len(shown), views[0], shown[0].section.plane.labels)
    for axes, moment, view in zip(panels, shown, views, strict=True):
        drawn = axes.tripcolor(
            *moment.section.triangles(colours.values(moment)),
            shading="gouraud",
            cmap=colours.map,
            vmin=colours.lowest,
            vmax=colours.highest or 1.0,
        )
        if over is not None:
            over(axes, moment, view)
        for outline in moment.outlines:
            axes.plot(*outline.T, color=BLACK, linewidth=0.8)
        _look_at(axes, view)
        axes.set_title(f"time {moment.time:.4g}")
    extend = "both" if colours.lowest < 0.0 else "neither"
    figure.colorbar(drawn, ax=panels, label=colours.label, shrink=0.8, extend=extend)
    return figure


def frame(count: int, view: View, labels: tuple[str, str]) -> tuple[Figure, list[Axes]]:
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
        axes.set_xlabel(labels[0])
    for row in grid:
        row[0].set_ylabel(labels[1])
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
    sections = [moment.section for moment in shown]
    seen = [one.speed[view.holds(one.flat_points)] for one, view in zip(sections, views, strict=True)]
    fastest = max(float(values.max(initial=0.0)) for values in seen)
    return Colours("speed [length/time]", COLOURMAP, 0.0, fastest, lambda moment: moment.section.speed)


def _signed_picture(shown: Sequence[Moment], label: str, of: Callable[[Moment], FloatArray]) -> Figure:
    """Values about zero, with colours for those of most nodes."""
    size = np.concatenate([np.abs(of(moment)).ravel() for moment in shown])
    highest = float(np.percentile(size, SHARE))
    colours = Colours(label, SIGNED_COLOURMAP, -highest, highest, of)
    return _panels(shown, [View.whole(moment) for moment in shown], colours)


def _draw_mesh(axes: Axes, moment: Moment, view: View) -> None:
    axes.add_collection(LineCollection(list(moment.section.edges), colors="white", linewidths=0.3), autolim=False)


def _draw_streamlines(axes: Axes, moment: Moment, view: View) -> None:
    """Lines along the velocity, none where the fluid rests to rounding, or goes through the slice rather than along."""
    section, grid = moment.section, Grid.between(view.lower, view.upper, _GRID)
    sampling = Sampling.locate(section.fields, grid.lifted(section.plane, section.through))
    velocity = section.fields.velocity[section.fields.cells]
    u, v = (sampling.image(velocity @ direction) for direction in (section.plane.right, section.plane.up))
    speed = np.linalg.norm([sampling.image(component) for component in np.moveaxis(velocity, 2, 0)], axis=0)
    along = np.hypot(u, v)  # nan outside the mesh, as the speed is
    moving = (along > _CALM * section.speed.max()) & (along >= np.cos(np.radians(_OUT_OF_PLANE)) * speed)
    if not moving.any():
        return
    x = grid.origin[0] + grid.right[0] * np.arange(grid.columns)
    y = grid.origin[1] + grid.up[1] * np.arange(grid.rows)
    size = view.upper - view.lower
    u, v = (np.ma.masked_where(~moving, values) for values in (u, v))
    density = tuple(np.maximum(1.5 * size / size.max(), 0.25))
    axes.streamplot(x, y, u, v, density=density, color="white", linewidth=0.6, arrowsize=0.6)
