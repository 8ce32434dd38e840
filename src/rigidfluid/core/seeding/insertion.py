"""Random sequential insertion: bodies take places one by one, and never move."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.seeding.clearance import Surroundings
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.regions import Region

_TRIES, _ROUNDS = 128, 40
"""Places that are drawn at once, and how often, before a body finds none."""


class Insertion:
    """Places in a ``region`` that are clear of the surfaces ``around``, one as likely as another.

    Notes
    -----
    J. Feder, Random sequential adsorption, J. Theor. Biol. 87 (1980) 237, doi:10.1016/0022-5193(80)90358-6.
    """

    def __init__(self, region: Region, around: Surroundings, draws: Draws) -> None:
        self._region, self._surfaces, self._draws = region, around.all, draws

    def places(self, radii: FloatArray, gap: float, others: FloatArray, bounds: FloatArray) -> FloatArray | None:
        """Centres (n, d) of balls of ``radii`` (n,) with at least ``gap`` to each other, to surfaces, and to balls of
        radii ``bounds`` (m,) around the centres ``others`` (m, d); None if one finds no place [length].

        The largest ball comes first.
        """
        count = len(radii)
        centres = np.concatenate([others, np.zeros((count, others.shape[1]))])
        sizes = np.concatenate([bounds, np.zeros(count)])
        found = np.zeros((count, others.shape[1]))
        for placed, body in enumerate(np.argsort(-radii, kind="stable").tolist(), start=len(others)):
            place = self._place(radii[body], gap, centres[:placed], sizes[:placed])
            if place is None:
                return None
            centres[placed], sizes[placed], found[body] = place, radii[body], place
        return found

    def _place(self, radius: float, gap: float, centres: FloatArray, sizes: FloatArray) -> FloatArray | None:
        lower, upper = self._region.extent
        for _ in range(_ROUNDS):
            tried = lower + (upper - lower) * self._draws.uniform(_TRIES, len(lower))
            tried = tried[self._is_clear(tried, radius + gap)]
            distance = np.sqrt(np.sum((tried[:, None] - centres) ** 2, axis=2))
            free = np.flatnonzero(np.all(distance >= sizes + radius + gap, axis=1))
            if len(free):
                return np.asarray(tried[free[0]])
        return None

    def _is_clear(self, points: FloatArray, room: float) -> BoolArray:
        """Tell whether points (N, d) are inside with so much room around them, (N,)."""
        clear = self._region.contains(points)
        for surface in self._surfaces:
            clear[clear] = surface.signed_distance(points[clear]) >= room
        return clear
