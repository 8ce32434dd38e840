"""Pictures of a flow, in 3D of a slice of it: speed, pressure, vorticity, streamlines and mesh; mesh about one body."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.moment import Moment, View
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.scale import Scale
from rigidfluid.post.reports.section import Section
from rigidfluid.post.reports.style import BLACK, BODY, HATCH, OUTSIDE, new_figure

TALLEST, NARROWEST = 8.0, 1.4
"""A panel's greatest height, and the least width of its place [inch]."""

LOWEST = 2.0
"""The least height of a picture, for the words along its colour bar [inch]."""

_GRID = 400  # points along the longer side from which streamlines are drawn
_CALM = 1e-4  # of the highest speed: where the fluid is slower, rounding decides where it goes
_OUT_OF_PLANE = 45.0  # degrees between velocity and slice from which on a line in the slice tells little


Over = Callable[[Axes, Moment, View], object]
"""Function that draws over the colours."""

OnBodies = Callable[[Axes, Moment, Scale], object]
"""Function that draws over the bodies."""


def flow_picture(shown: Sequence[Moment], scale: Scale) -> Figure:
    """Speed, pressure or vorticity, of a slice its component to the observer, in the whole domain."""
    return _panels(shown, [View.whole(moment) for moment in shown], scale)


def scalar_picture(shown: Sequence[Moment], scale: Scale) -> Figure:
    """A scalar that the fluid carries along, in bodies that conduct it too."""
    return _panels(shown, [View.whole(moment) for moment in shown], scale, on_bodies=_draw_insides)


def viscosity_picture(shown: Sequence[Moment], scale: Scale, yield_stress: float | None) -> Figure:
    """Viscosity, with a line where the stress is the ``yield_stress`` [force/length^(d-1)], if there is one."""
    whole = [View.whole(moment) for moment in shown]
    return _panels(shown, whole, scale, None if yield_stress is None else partial(_draw_yielded, yield_stress))


def streamline_picture(shown: Sequence[Moment], scale: Scale) -> Figure:
    """Streamlines over the speed, seen by an observer at rest."""
    return _panels(shown, [View.whole(moment) for moment in shown], scale, _draw_streamlines)


def whole_mesh_picture(moment: Moment, scale: Scale) -> Figure:
    """All cells over the speed."""
    return _panels([moment], [View.whole(moment)], scale, _draw_mesh)


def mesh_picture(shown: Sequence[Moment], scale: Scale) -> Figure:
    """Speed and mesh about one body."""
    return _mesh_panels(shown, [View.about(moment.centre, 1.5 * moment.width) for moment in shown], scale)


def gap_picture(moment: Moment, middle: FloatArray, scale: Scale) -> Figure:
    """Close-up of a gap about its ``middle`` (2,), with its cells."""
    return _mesh_panels([moment], [View.about(middle, min(4.0 * moment.gap, moment.width))], scale)


def _mesh_panels(shown: Sequence[Moment], views: Sequence[View], scale: Scale) -> Figure:
    figure = _panels(shown, views, scale, _draw_mesh)
    for axes, moment in zip(figure.axes, shown, strict=False):
        axes.set_title(f"time {moment.time:.4g} [time], gap {moment.gap:.3g} [length]")
    return figure


def _panels(
    shown: Sequence[Moment],
    views: Sequence[View],
    scale: Scale,
    over: Over | None = None,
    on_bodies: OnBodies | None = None,
) -> Figure:
    """One panel a moment, bodies grey, what is outside hatched, the same colours for the same value in all."""
    figure, panels = frame(len(shown), views[0], shown[0].section.plane.labels)
    for axes, moment, view in zip(panels, shown, views, strict=True):
        _draw_colours(axes, moment.section, scale)
        if over is not None:
            over(axes, moment, view)
        for outline in moment.outlines:
            axes.fill(*outline.T, facecolor=BODY, edgecolor=BLACK, linewidth=0.8)
        if on_bodies is not None:
            on_bodies(axes, moment, scale)
        _look_at(axes, view)
        axes.set_title(f"time {moment.time:.4g} [time]")
    scale.draw_bar(figure, panels, 3 if shown[0].section.is_slice else 2)
    return figure


def frame(count: int, view: View, labels: tuple[str, str]) -> tuple[Figure, list[Axes]]:
    """Panels in a row for a tall view, in a column for a flat one, else two by two; low enough for a page."""
    width, height = view.upper - view.lower
    columns = min(count, 4 if height > 1.5 * width else 2 if height > 0.8 * width else 1)
    rows = -(-count // columns)
    panel_width = min(7.2 / max(columns, 1.5), TALLEST * width / height)
    place = max(panel_width, NARROWEST)
    panels_height = rows * (panel_width * height / width + 0.5) + 0.3
    figure = new_figure(columns * place + 2.0, max(panels_height, LOWEST))
    # Other layouts take the room beside panels of a fixed shape for room for their labels.
    figure.set_layout_engine("compressed")
    grid = figure.subplots(rows, columns, squeeze=False)
    for unused in grid.ravel()[count:]:
        unused.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel(labels[0])
    for row in grid:
        row[0].set_ylabel(labels[1])
    return figure, list(grid.ravel()[:count])


def _look_at(axes: Axes, view: View) -> None:
    axes.patch.set(facecolor=OUTSIDE, edgecolor=HATCH, hatch="////", linewidth=0.0)
    axes.grid(visible=False)
    axes.set_aspect("equal")
    axes.set_xlim(view.lower[0], view.upper[0])
    axes.set_ylim(view.lower[1], view.upper[1])
    width, height = view.upper - view.lower
    axes.locator_params(axis="x", nbins=4 if height < 1.5 * width else 2 if height < 4.0 * width else 1)
    axes.locator_params(axis="y", nbins=4 if width < 4.0 * height else 2)


def _draw_colours(axes: Axes, section: Section, scale: Scale) -> None:
    values = section.triangles(section.values(scale.quantity))
    axes.tripcolor(*values, shading="gouraud", cmap=scale.map, norm=scale.norm)


def _draw_insides(axes: Axes, moment: Moment, scale: Scale) -> None:
    """The scalar inside bodies that conduct, below the outlines."""
    if moment.insides is None:
        return
    _draw_colours(axes, moment.insides, scale)
    axes.add_collection(LineCollection(list(moment.outlines), colors=BLACK, linewidths=0.8), autolim=False)


def _draw_mesh(axes: Axes, moment: Moment, view: View) -> None:
    axes.add_collection(LineCollection(list(moment.section.edges), colors="white", linewidths=0.3), autolim=False)


def _draw_yielded(yield_stress: float, axes: Axes, moment: Moment, view: View) -> None:
    """A line where the stress is the ``yield_stress``, if it is that anywhere."""
    triangulation, stress = moment.section.triangles(moment.section.stress)
    if stress.min() < yield_stress < stress.max():
        axes.tricontour(triangulation, stress, levels=[yield_stress], colors="white", linewidths=1.0)


def _draw_streamlines(axes: Axes, moment: Moment, view: View) -> None:
    """Lines along the velocity, none where the fluid rests to rounding, or goes through the slice rather than along."""
    section, grid = moment.section, Grid.between(view.lower, view.upper, _GRID)
    in_space = grid.lifted(section.plane, section.through)
    u, v = (section.image(component, in_space) for component in section.plane.flat(section.fields.velocity).T)
    speed = section.image(section.speed, in_space)
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
