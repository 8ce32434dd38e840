"""The paths of bodies through the domain, seen in a plane."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.post.reports.bodies import cut, placed_bodies
from rigidfluid.post.reports.curves import MOST_LINES
from rigidfluid.post.reports.plane import distance_grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.style import BLACK, BLUE, PALETTE
from rigidfluid.post.reports.view_plane import ViewPlane

_PLACES = 5
"""Number of times, start and end among them, at which bodies are drawn on their paths."""


def draw_paths(axes: Axes, results: Results, plane: ViewPlane) -> None:
    """Paths as the plane shows them, and each body as the plane through its own centre cuts it: few bodies at some
    times, many at the end; in 3D with the domain as the plane through the first body's start cuts it."""
    position = results.quantity("position")
    axes.contour(
        *distance_grid(results.system.domain, plane, position[0, 0]), levels=[0.0], colors=BLACK, linewidths=0.8
    )
    many = len(results.names) > MOST_LINES
    last = len(results.time) - 1
    states = (
        [last] if many else [results.state_at(time) for time in np.linspace(results.time[0], results.time[-1], _PLACES)]
    )
    for i, path in enumerate(plane.flat(position.swapaxes(0, 1))):
        colour = BLUE if many else PALETTE[i]
        axes.plot(*path.T, color=colour, linewidth=0.5 if many else 1.4, alpha=0.3 if many else 1.0)
    for state in states:
        _draw_bodies(axes, results, plane, state, filled=state == last)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel(plane.labels[0])
    axes.set_ylabel(plane.labels[1])
    axes.set_title("paths (filled: at the end)")


def _draw_bodies(axes: Axes, results: Results, plane: ViewPlane, state: int, *, filled: bool) -> None:
    many = len(results.names) > MOST_LINES
    for body in placed_bodies(results, state):
        colour = BLUE if many else PALETTE[body.number]
        for curve in cut(body, plane, body.centre):
            _draw_outline(axes, curve, colour, filled=filled)


def _draw_outline(axes: Axes, curve: FloatArray, colour: str, *, filled: bool) -> None:
    if filled:
        axes.fill(*curve.T, facecolor=colour, alpha=0.4, linewidth=0)
    axes.plot(*curve.T, color=colour, linewidth=0.8)
