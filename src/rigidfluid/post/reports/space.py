"""A view of a 3D run from a point in space: bodies, their paths, the box around the domain, and a slice of the flow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.canvas import Canvas, Shell, body_shells
from rigidfluid.post.reports.curves import MOST_LINES
from rigidfluid.post.reports.moment import Moment
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.scale import Scale
from rigidfluid.post.reports.style import BLACK, SOLID, VERMILLION, new_figure
from rigidfluid.post.reports.view_plane import ViewPlane

_AZIMUTH, _ELEVATION = np.radians(30.0), np.radians(20.0)
_ROOM = 0.3
"""Margin around the box, over the smaller of its width and height."""
_PIXELS = 900
"""Number of points along the longer side of a picture."""
_LONG = 0.3
"""Length of an edge with room for more than its name, over the larger half side of the picture."""
_PIECES = 200
"""Number of pieces of an edge, each of which may be hidden."""
_SLACK = 5e-3
"""Depth by which a line must be hidden to be left out, over the diagonal of the box: paths end in the bodies."""


def flow_space_picture(results: Results, shown: Sequence[Moment], plane: ViewPlane, scale: Scale) -> Figure:
    """Draw the run with slices of the speed."""
    return _panels(results, [moment.time for moment in shown], plane, shown, scale)


def dry_space_picture(results: Results, times: Sequence[float], plane: ViewPlane) -> Figure:
    """Draw a run without a fluid."""
    return _panels(results, times, plane, (), None)


def _panels(
    results: Results, times: Sequence[float], plane: ViewPlane, slices: Sequence[Moment], scale: Scale | None
) -> Figure:
    """Draw a panel for each time."""
    grid, shells = observed(plane, np.array(results.system.domain.extent)), body_shells(results)
    size = np.array([grid.columns, grid.rows])
    width, height = size / size.max()
    columns = min(len(times), 4 if height > 1.5 * width else 2)
    rows = -(-len(times) // columns)
    across = min(3.6, 5.5 * width / height + 0.8)
    figure = new_figure(columns * across + 1.5, rows * (across * height / width + 0.4))
    panels = [figure.add_subplot(rows, columns, k + 1, title=f"time {time:.4g} [time]") for k, time in enumerate(times)]
    for k, (axes, time) in enumerate(zip(panels, times, strict=True)):
        canvas, state = Canvas.blank(grid), results.state_at(time)
        if scale is not None:
            _paint_slice(canvas, slices[k], scale)
        draw_space(axes, canvas, results, state, shells)
    if scale is not None:
        scale.draw_bar(figure, panels, 3)
    return figure


def observed(plane: ViewPlane, box: FloatArray) -> Grid:
    """Points of a picture of a box (2, 3), by a distant observer to the right of the plane's normal, and above it."""
    level = np.cos(_AZIMUTH) * plane.normal + np.sin(_AZIMUTH) * plane.right
    to = np.cos(_ELEVATION) * level + np.sin(_ELEVATION) * plane.up
    right = np.cos(_AZIMUTH) * plane.right - np.sin(_AZIMUTH) * plane.normal
    seen = ViewPlane(right, np.cross(to, right))
    lower, upper = seen.extent(*box)
    room = 0.5 * _ROOM * (upper - lower).min()
    return Grid.between(lower - room, upper + room, _PIXELS).lifted(seen, box.mean(axis=0))


def _paint_slice(canvas: Canvas, moment: Moment, scale: Scale) -> None:
    section = moment.section
    speed = section.triangles(section.speed)[1].reshape(-1, 3, 1)
    canvas.paint(section.slice_points, speed, lambda at: scale.colours(at[:, 0]))


def draw_space(axes: Axes, canvas: Canvas, results: Results, state: int, shells: list[Shell]) -> None:
    """Draw bodies over what the canvas shows, then what can be seen of the edges of the box and of the paths."""
    canvas.paint_bodies(shells, results, state, SOLID, SOLID)
    axes.imshow(canvas.picture, origin="lower")
    box = np.array(results.system.domain.extent)
    edges = box_edges(box)
    share = np.linspace(0.0, 1.0, _PIECES)[:, None]
    for start, end in edges:
        _draw_visible(axes, canvas, (1.0 - share) * start + share * end, 0.0, (BLACK, 0.5))
    slack = _SLACK * float(np.linalg.norm(np.ptp(box, axis=0)))
    if len(results.system.bodies) <= MOST_LINES:
        position, present = results.quantity("position")[: state + 1], results.present[: state + 1]
        for path, there in zip(position.swapaxes(0, 1), present.T, strict=True):
            _draw_visible(axes, canvas, path[there], slack, (VERMILLION, 0.8))
    _name_edges(axes, canvas.grid, edges)


def _draw_visible(axes: Axes, canvas: Canvas, points: FloatArray, slack: float, pen: tuple[str, float]) -> None:
    """Draw those pieces of the line through ``points`` (K, 3) that nothing hides."""
    pieces = np.stack([points[:-1], points[1:]], axis=1)
    seen = canvas.grid.coordinates(pieces[canvas.shows(pieces.mean(axis=1), slack)])
    axes.add_collection(LineCollection(list(seen), colors=pen[0], linewidths=pen[1]), autolim=False)


def _name_edges(axes: Axes, grid: Grid, edges: FloatArray) -> None:
    """Write at three edges (12, 2, 3) along which axis they are, and from where to where at long ones."""
    axes.set_axis_off()
    seen = grid.coordinates(edges)
    for axis in range(3):
        mine = np.flatnonzero(np.ptp(edges, axis=1)[:, axis] > 0.0)
        step = np.diff(seen[mine[0]], axis=0)[0]
        rises = step[0] * step[1] > 0.0
        side = (-1.0, 0.0) if abs(step[1]) > 2.0 * abs(step[0]) else (0.5 if rises else -0.5, -1.0)
        edge = mine[np.argmax(seen[mine].mean(axis=1) @ side)]
        angle = np.degrees(np.arctan2(*step[::-1]))
        text = "xyz"[axis]
        if np.linalg.norm(step) > _LONG * 0.5 * max(grid.columns, grid.rows):
            text += f" [length], {edges[edge, 0, axis]:.4g} to {edges[edge, 1, axis]:.4g}"
        place, away = seen[edge].mean(axis=0), (9.0 * side[0], 9.0 * side[1])
        axes.annotate(text, place, away, textcoords="offset points", rotation=(angle + 89.0) % 180.0 - 89.0,
                      rotation_mode="anchor", ha="center", va="center", fontsize=8)  # fmt: skip


def box_edges(box: FloatArray) -> FloatArray:
    """The twelve edges (12, 2, 3) of a box (2, 3)."""
    corners = np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1)
    return np.concatenate([np.moveaxis(corners, axis, 2).reshape(4, 2, 3) for axis in range(3)])
