"""Where a movie looks: a window of the plane, in 3D of a plane through a body; it may go with a body."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.model.types import FloatArray
from rigidfluid.errors import OutputError
from rigidfluid.reports.raster import Grid
from rigidfluid.reports.results import Results
from rigidfluid.reports.view_plane import PlaneName, ViewPlane, view_plane

_MARGIN = 2.0
"""Widths of a body that are seen about one that is followed, to each side."""

Window = tuple[float, float, float, float]


@dataclass(frozen=True)
class Shot:
    """The grid at each state: in the ``plane`` through the points ``through`` (s, d), from ``lower`` to ``upper`` (2,),
    moved by ``shift`` (s, 2) to the right and up."""

    plane: ViewPlane
    through: FloatArray
    lower: FloatArray
    upper: FloatArray
    shift: FloatArray

    def grid(self, state: int, longer: int) -> Grid:
        """The points of a picture, ``longer`` of them along its longer side."""
        flat = Grid.between(self.lower, self.upper, longer)
        return replace(flat, origin=flat.origin + self.shift[state]).lifted(self.plane, self.through[state])

    def extent(self, state: int) -> tuple[float, float, float, float]:
        """Left, right, lower and upper end."""
        (left, low), (right, high) = self.lower + self.shift[state], self.upper + self.shift[state]
        return float(left), float(right), float(low), float(high)


def shot_of(results: Results, follow: str | None, window: Window | None, plane: PlaneName = "motion") -> Shot:
    """The whole domain, a window of it, or what is about a body.

    Parameters
    ----------
    results : Results
        A run.
    follow : str or None
        The body that the picture goes with.
    window : tuple of float or None
        Left, lower, right and upper end [length]; with ``follow`` from the body's centre on.
    plane : str
        Which plane of a 3D run, as `view_plane` takes it; through the body that is followed, or the first one.

    Raises
    ------
    OutputError
        If there is no such body or plane, or nothing in the window.
    """
    seen = view_plane(results, plane)
    body = 0 if follow is None else results.number_of(follow)
    through = results.vectors("")[:, body]
    lower, upper = seen.extent(*results.system.domain.extent)
    shift = np.zeros((len(through), 2))
    if follow is not None:
        shift = seen.flat(through)
        half = _MARGIN * 2.0 * results.system.bodies[body].bounding_radius * np.ones(2)
        lower, upper = -half, half
    if window is not None:
        lower, upper = np.array(window[:2]), np.array(window[2:])
        if not np.all(upper > lower):
            raise OutputError(
                "--view", window, "left, lower, right and upper end, in this order", "Give them in this order."
            )
    return Shot(seen, through, lower, upper, shift)
