"""A movie's section of the plane, in 3D of a plane through a body; it may go with a body."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.raster import Grid
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.view_plane import PlaneName, ViewPlane, view_plane

_MARGIN = 2.0
"""Half the width of the picture of a body that is followed, over the body's."""

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
    """Shot of the whole domain, of a ``window`` (left, lower, right, upper end [length]), or about a body.

    With a body to ``follow`` the window is relative to its centre. The plane of a 3D run, as `view_plane` takes it,
    goes through that body, else the first. Raises OutputError for an unknown body or plane, or an empty window.
    """
    seen = view_plane(results, plane)
    body = 0 if follow is None else results.number_of(follow)
    through = results.path(body)
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
