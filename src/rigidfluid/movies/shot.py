"""Where a movie looks: a window of the plane, in 3D of a plane through the bodies; it may go with a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import OutputError
from rigidfluid.reports.raster import Grid
from rigidfluid.reports.results import Results

_MARGIN = 2.0
"""Widths of a body that are seen about one that is followed, to each side."""

Window = tuple[float, float, float, float]


@dataclass(frozen=True)
class Shot:
    """The grid at each state, whose middle moves by ``shift`` (s, d).

    ``axes``: which coordinates go to the right and up. ``lower``, ``upper`` (2,): the window at no shift; ``depth``
    (s, d): where the plane is, zero along its own axes.
    """

    axes: tuple[int, int]
    lower: FloatArray
    upper: FloatArray
    shift: FloatArray
    depth: FloatArray

    def grid(self, state: int, longer: int) -> Grid:
        """The points of a picture, ``longer`` of them along its longer side."""
        flat = Grid.between(self.lower, self.upper, longer)
        place = self.depth[state] + self.shift[state]
        if len(place) == 2:
            return Grid(flat.origin + place, flat.right, flat.up, flat.columns, flat.rows)
        origin, right, up = (np.zeros(3) for _ in range(3))
        for vector, values in ((origin, flat.origin), (right, flat.right), (up, flat.up)):
            vector[list(self.axes)] = values
        return Grid(origin + place, right, up, flat.columns, flat.rows)


def shot_of(results: Results, follow: str | None, window: Window | None) -> Shot:
    """The whole domain, a window of it, or what is about a body.

    Parameters
    ----------
    results : Results
        A run.
    follow : str or None
        The body that the picture goes with.
    window : tuple of float or None
        Left, lower, right and upper end [length]; with ``follow`` from the body's centre on.

    Raises
    ------
    OutputError
        If there is no such body, or nothing in the window.
    """
    axes, position = _axes(results), results.vectors("")
    lower, upper = (corner[list(axes)] for corner in results.system.domain.extent)
    shift, depth = np.zeros((len(position), position.shape[2])), np.zeros((len(position), position.shape[2]))
    body = 0 if follow is None else _number(results, follow)
    if len(axes) < position.shape[2]:
        across = ({0, 1, 2} - set(axes)).pop()
        depth[:, across] = position[:, body, across]
    if follow is not None:
        shift[:, list(axes)] = position[:, body][:, list(axes)]
        half = _MARGIN * 2.0 * results.system.bodies[body].bounding_radius * np.ones(2)
        lower, upper = -half, half
    if window is not None:
        lower, upper = np.array(window[:2]), np.array(window[2:])
        if not np.all(upper > lower):
            raise OutputError(
                "--view", window, "left, lower, right and upper end, in this order", "Give them in this order."
            )
    return Shot(axes, lower, upper, shift, depth)


def _axes(results: Results) -> tuple[int, int]:
    """In 3D gravity's axis goes up, and to the right the other one along which bodies move or the domain is longer."""
    if results.system.dimension == 2:
        return 0, 1
    gravity = np.abs(np.asarray(results.scene.fluid.gravity or (0.0, 0.0, 0.0)))
    up = int(np.argmax(gravity)) if gravity.any() else 1
    moved = np.ptp(results.vectors(""), axis=(0, 1)) + 1e-6 * results.system.domain.size
    moved[up] = -1.0
    return int(np.argmax(moved)), up


def _number(results: Results, name: str) -> int:
    if name not in results.names:
        raise OutputError("--follow", name, f"a body: {', '.join(results.names[:20])}", "Name one of them.")
    return results.names.index(name)
