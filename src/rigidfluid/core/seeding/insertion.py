"""Random sequential insertion: bodies take places one by one, and never move."""

from __future__ import annotations

import numpy as np
import scipy

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.seeding.clearance import Surroundings
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.regions import Region

_TRIES, _ROUNDS = 32, 160
"""Places that are drawn at once, and how often, before a body finds none."""

_RECENT = 64
"""Number of balls that are searched one by one before they are put into a tree."""


class Insertion:
    """Places in a ``region`` that are clear of the surfaces ``around`` and of images, one as likely as another.

    Notes
    -----
    J. Feder, Random sequential adsorption, J. Theor. Biol. 87 (1980) 237, doi:10.1016/0022-5193(80)90358-6.
    """

    def __init__(self, region: Region, around: Surroundings, draws: Draws) -> None:
        self._region, self._surfaces, self._draws = region, around.all, draws
        self._lattice = around.lattice

    def places(self, radii: FloatArray, gap: float, others: FloatArray, bounds: FloatArray) -> FloatArray | None:
        """Centres (n, d) of balls of ``radii`` (n,) with at least ``gap`` to each other, to surfaces, and to balls of
        radii ``bounds`` (m,) around the centres ``others`` (m, d); None if one finds no place [length].

        The largest ball comes first.
        """
        placed, found = _Balls(others, bounds, self._lattice), np.zeros((len(radii), others.shape[1]))
        for body in np.argsort(-radii, kind="stable").tolist():
            place = self._place(float(radii[body]) + gap, placed)
            if place is None:
                return None
            placed.add(place, float(radii[body]))
            found[body] = place
        return found

    def _place(self, room: float, placed: _Balls) -> FloatArray | None:
        """A place (d,) with so much ``room`` around it, if one is found [length]."""
        lower, upper = self._region.extent
        for _ in range(_ROUNDS):
            tried = lower + (upper - lower) * self._draws.uniform(_TRIES, len(lower))
            tried = tried[self._is_clear(tried, room)]
            free = placed.first_clear(tried, room)
            if free is not None:
                return free
        return None

    def _is_clear(self, points: FloatArray, room: float) -> BoolArray:
        """Tell whether points (N, d) are inside with so much room around them, (N,)."""
        clear = self._region.contains(points)
        for surface in self._surfaces:
            clear[clear] = surface.signed_distance(points[clear]) >= room
        return clear


class _Balls:
    """Balls around ``centres`` (m, d) with ``radii`` (m,) [length] and their images by a ``lattice``, to which others
    are added."""

    def __init__(self, centres: FloatArray, radii: FloatArray, lattice: Lattice) -> None:
        self._centres, self._radii, self._lattice = list(centres), radii.tolist(), lattice
        self._plant()

    def add(self, centre: FloatArray, radius: float) -> None:
        """A further ball."""
        self._centres.append(centre)
        self._radii.append(radius)
        if len(self._centres) - self._planted >= _RECENT:
            self._plant()

    def first_clear(self, points: FloatArray, room: float) -> FloatArray | None:
        """The first of ``points`` (N, d) that is so far from all balls, if any."""
        if self._planted and len(points):
            nearest = np.asarray(self._tree.query(points)[0])
            points = points[nearest >= self._least + room]  # of balls of one size there are no others
        centres, radii = np.reshape(self._centres, (-1, points.shape[1])), np.array(self._radii)
        for point in points:
            if np.all(np.linalg.norm(self._lattice.shortened(centres - point), axis=1) >= radii + room):
                return np.asarray(point)
        return None

    def _plant(self) -> None:
        """Put all balls into the tree."""
        self._planted = len(self._centres)
        if self._planted:
            self._tree = scipy.spatial.cKDTree(np.array(self._centres))
            self._least = min(self._radii)
