"""Points of surfaces that are measured to other surfaces, those of all pairs at once: corners, and centres of balls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.facet_surface import Nearby, nearby
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.detectors.placed_facets import Solid
from rigidfluid.detectors.touches import Touches, all_touches


class Pairs(NamedTuple):
    """Pairs of surfaces ``a`` and ``b`` (K,), by their rows, and how much farther than the nearest place of a pair
    others may be, ``spread`` (K,) [length]."""

    a: IntArray
    b: IntArray
    spread: FloatArray


class Placement(NamedTuple):
    """All surfaces where they stand: ``position`` (S, d), ``rotation`` (S, d, d)."""

    position: FloatArray
    rotation: FloatArray

    def lab(self, surface: IntArray, points: FloatArray) -> FloatArray:
        """Points (N, d) in the frames of these surfaces (N,), in that of the domain."""
        return self.position[surface] + self.turned(surface, points)

    def turned(self, surface: IntArray, vectors: FloatArray) -> FloatArray:
        """Vectors (N, d) in the frames of these surfaces (N,), in that of the domain."""
        return np.asarray(np.einsum("nij,nj->ni", self.rotation[surface], vectors))

    def local(self, surface: IntArray, points: FloatArray) -> FloatArray:
        """Points (N, d) of the domain in the frames of these surfaces (N,)."""
        return np.asarray(np.einsum("nij,ni->nj", self.rotation[surface], points - self.position[surface]))


class Probed(NamedTuple):
    """A surface by its ``points`` (p, d) that are measured to others, with a ``radius`` around each [length], and its
    ``target``, to which others are measured: facets, a flat or round wall, or None."""

    points: FloatArray
    radius: float
    target: Solid | Surface | None


class Probes:
    """Contacts of corners and balls of some surfaces with facets and walls of others.

    A corner at x with nearest point p of the other surface has gap = |x - p| and normal (x - p)/|x - p|. It counts
    near or far, and whatever side of its body it is on: the distance of a point to a convex surface has a continuous
    slope, so that no force jumps. A corner has the nearest side of a hollow alone.
    """

    def __init__(self, surfaces: Sequence[Probed]) -> None:
        self._count = np.array([len(each.points) for each in surfaces], dtype=np.int64)
        self._first = np.cumsum(self._count) - self._count
        self._points = np.concatenate([each.points for each in surfaces])
        self._radius = np.array([each.radius for each in surfaces], dtype=float)
        targets = [each.target for each in surfaces]
        self._targets = list({id(each): each for each in targets if each is not None}.values())
        number = {id(target): row for row, target in enumerate(self._targets)}
        self._target = np.array([number.get(id(each), -1) for each in targets], dtype=np.int64)
        self._lower, self._upper = (np.array(each) for each in zip(*map(_box, surfaces), strict=True))
        with np.errstate(invalid="ignore"):  # endless boxes are only others'
            self._middle = 0.5 * (self._lower + self._upper)
            self._half = self._upper - self._middle

    def touches(self, pairs: Pairs, placed: Placement, reach: float) -> Touches:
        """Contacts of all ``pairs`` with gaps up to ``reach`` [length]."""
        own, other = np.concatenate([pairs.a, pairs.b]), np.concatenate([pairs.b, pairs.a])
        chosen = np.flatnonzero((self._count[own] > 0) & (self._target[other] >= 0))
        chosen = chosen[self.boxes_meet(own[chosen], other[chosen], placed, reach)]
        row, point = self._rows(chosen, own)
        own, other, pair = own[row], other[row], row % max(len(pairs.a), 1)
        place, radius = placed.lab(own, self._points[point]), self._radius[own]
        local, parts = placed.local(other, place), []
        near = np.flatnonzero(self._in_box(other, local, reach + radius))
        for number in np.unique(self._target[other[near]]).tolist():
            rows = near[self._target[other[near]] == number]
            target, corner = self._targets[number], radius[rows] == 0.0
            found = _measured(target, local[rows], reach + radius[rows], pairs.spread[pair[rows]])
            found = _nearest_sides(found, target, corner)
            there = rows[found.point]
            foot, normal = placed.lab(other[there], found.foot), placed.turned(other[there], found.normal)
            point_a, gap = place[there] - radius[there, None] * normal, found.distance - radius[there]
            found_here = Touches(pair[there], point_a, foot, normal, gap, np.ones(len(gap)))
            parts.append(found_here.turned(row[there] >= len(pairs.a)))
        return all_touches(parts, self._points.shape[1])

    def boxes_meet(self, own: IntArray, other: IntArray, placed: Placement, reach: float | FloatArray) -> BoolArray:
        """Tell whether the box around each surface, in the frame of another one, is within ``reach`` of the box around
        that, (K,) each."""
        if len(own) == 0:
            return np.zeros(0, dtype=bool)
        turned = np.abs(np.einsum("nki,nkj->nij", placed.rotation[other], placed.rotation[own]))
        half = np.einsum("nij,nj->ni", turned, self._half[own]) + np.reshape(reach, (-1, 1))
        centre = placed.local(other, placed.lab(own, self._middle[own]))
        meet = (centre + half >= self._lower[other]) & (centre - half <= self._upper[other])
        return np.asarray(np.all(meet, axis=1))

    def _rows(self, chosen: IntArray, own: IntArray) -> tuple[IntArray, IntArray]:
        """Row in ``chosen`` pairs, and in all points, of each point of the surfaces ``own``."""
        count = self._count[own[chosen]]
        start = np.repeat(self._first[own[chosen]] - np.cumsum(count) + count, count)
        return np.repeat(chosen, count), start + np.arange(len(start))

    def _in_box(self, surface: IntArray, local: FloatArray, span: FloatArray) -> BoolArray:
        """Tell whether each point is as near as ``span`` (N,) to the box around its other surface."""
        low, high = self._lower[surface] - span[:, None], self._upper[surface] + span[:, None]
        return np.asarray(np.all((local >= low) & (local <= high), axis=1))


def _box(surface: Probed) -> tuple[FloatArray, FloatArray]:
    """Corners of the box around a surface, infinite around one without facets that has no points."""
    if isinstance(surface.target, Solid):
        return surface.target.surface.bounds
    if len(surface.points):
        return surface.points.min(axis=0) - surface.radius, surface.points.max(axis=0) + surface.radius
    endless = np.full(surface.points.shape[1], np.inf)
    return -endless, endless


def _measured(target: Solid | Surface, points: FloatArray, reach: FloatArray, spread: FloatArray) -> Nearby:
    return nearby(target if isinstance(target, Surface) else target.surface, points, reach, spread)


def _nearest_sides(found: Nearby, target: Solid | Surface, corner: BoolArray) -> Nearby:
    """Places without those of a ``corner`` (N,) on a hollow that has a nearer one."""
    if isinstance(target, Surface) or np.all(np.bincount(found.point) <= 1):
        return found
    order = np.argsort(found.distance, kind="stable")
    hollow = found.point * len(target.hollows) + target.hollows[found.facet]
    number = np.where(corner[found.point], hollow, -1 - np.arange(len(hollow)))
    nearest = order[np.unique(number[order], return_index=True)[1]]
    return found.select(np.sort(nearest))
