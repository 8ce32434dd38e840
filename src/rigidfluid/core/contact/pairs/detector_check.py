"""Spot checks of the detector against a naive search: no answer alone shows that it has not seen a contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from rigidfluid.core.contact.pairs.broad_phase import near_pairs
from rigidfluid.core.contact.pairs.proximity import detect
from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.guarded import part_error
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.core.geometry.wrong import Wrong
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Contacts, Mesh, Pose

MOST_PAIRS = 3
"""Largest number of pairs that are looked at of those that seem nearest, and of those that were not found."""

_SAMPLES = 100
"""Points tried on the surface of a body."""

_PROJECTIONS = 10
"""Number of ways to the other surface and back, each of which brings two points nearer to each other."""

_ROUNDING = 1e-6
"""Greatest error of an exact detector, over the bounding radius."""

_FAR = 1e-9
"""Greatest error of contact points by rounding, over the distance of the surfaces."""

_ROUGH = 0.1
"""The same of one that does not say that it is exact."""


class _Near(NamedTuple):
    """Pairs by their numbers, of a body and of another or a wall (m,), and gaps of their bounding balls (m,) [length],
    which are those of balls."""

    first: IntArray
    second: IntArray
    gap: FloatArray


class _Side(NamedTuple):
    """A surface by its number, where it stands, and the most that contact points may lie off it [length]."""

    number: int
    shape: Surface
    position: FloatArray
    rotation: FloatArray
    off: float

    def distance(self, points: FloatArray) -> FloatArray:
        return self.shape.signed_distance((points - self.position) @ self.rotation)

    def closest(self, points: FloatArray) -> FloatArray:
        foot = self.shape.closest_point((points - self.position) @ self.rotation)
        return np.asarray(self.position + foot @ self.rotation.T)

    def samples(self) -> FloatArray:
        assert isinstance(self.shape, Body)
        return np.asarray(self.position + self.shape.sample_surface(_SAMPLES) @ self.rotation.T)


def check_detector(system: System, pose: Pose, mesh: Mesh | None, count: int) -> None:
    """Raise PluginError unless the detector finds the nearest pairs at a ``pose``, all balls in reach, and some other
    pairs, drawn by ``count``; with points on both surfaces, and none farther apart than two points of a naive search;
    on a ``mesh`` as far as facets lie off the surfaces, and the nearest only, as others may be hidden behind them."""
    exact = system.detection.on_mesh or bool(system.detector.exact_for(system.bodies, system.domain.pieces))
    error = _ROUNDING if exact else _ROUGH
    near = _in_reach(system, pose)
    rows = np.argsort(near.gap, kind="stable")[:MOST_PAIRS]
    if not system.detection.on_mesh:
        rows = np.append(rows, _not_found(system, pose, near, error, count))
    pairs = list(zip(near.first[rows].tolist(), near.second[rows].tolist(), strict=True))
    looked_at = list(_searched_pairs(system, pose, mesh, pairs, error))
    if looked_at:
        found = _without_images(detect(system, pose, mesh, max(reach for _, _, reach in looked_at)))
        for a, b, reach in looked_at:
            _compare(system, found, (a, b), reach)


def _searched_pairs(
    system: System, pose: Pose, mesh: Mesh | None, pairs: Sequence[tuple[int, int]], error: float
) -> Iterator[tuple[_Side, _Side, float]]:
    """Both sides of pairs, and the gap at most at which a detector of a relative ``error`` has to find them; without
    those that are nearest where two pieces of the boundary meet, as one contact is enough there, and on a mesh without
    those that its reach leaves out."""
    for pair in pairs:
        off = error * system.bodies[pair[0]].bounding_radius
        a, b = (_side(system, pose, mesh, number, off) for number in pair)
        apart, foot = _searched(a, b)
        reach = apart + a.off + b.off
        if system.detection.on_mesh:
            has_to = apart > 0.0 and reach <= system.reach
        else:
            has_to = not _pieces_meet(system, b, foot)
        if has_to:
            yield a, b, reach


def _without_images(contacts: Contacts) -> Contacts:
    """Contacts of bodies where they are."""
    return contacts if contacts.shift is None else select(contacts, np.all(contacts.shift == 0.0, axis=1))


def _compare(system: System, found: Contacts, sides: tuple[_Side, _Side], reach: float) -> None:
    a, b = sides
    rows = np.flatnonzero((found.body_a == a.number) & (found.body_b == b.number) & (found.gap <= reach))
    names = f"{system.surfaces[a.number]} and {system.surfaces[b.number]}"
    if len(rows) == 0:
        _refuse_contradictory(sides)
        wrong = Wrong(f"no contact of {names}", f"one with a gap of {reach:.6g} at most, which a naive search finds")
        raise part_error(system.detector, "detect", wrong)
    for side, points in ((a, found.point_a[rows]), (b, found.point_b[rows])):
        off, allowed = float(np.abs(side.distance(points)).max()), side.off + _FAR * reach
        if off > allowed:
            _refuse_contradictory(sides)
            surface = system.surfaces[side.number]
            wrong = Wrong(f"a contact of {names} {off:.3g} off {surface}", f"points on it, or {allowed:.3g} off")
            raise part_error(system.detector, "detect", wrong)


def _refuse_contradictory(sides: tuple[_Side, _Side]) -> None:
    """Raise PluginError for a body whose samples are not on its surface: then the detector may be right."""
    for side in sides:
        if isinstance(side.shape, Body):
            off = float(np.abs(side.distance(side.samples())).max())
            if off > _ROUNDING * side.shape.bounding_radius:
                wrong = Wrong(f"points that are {off:.3g} from the surface by its `signed_distance`", "points on it")
                raise part_error(side.shape, "sample_surface", wrong)


def _in_reach(system: System, pose: Pose) -> _Near:
    """Pairs whose bounding balls are in the detector's reach of each other."""
    position, radii = pose.position, system.bounding_radii
    a, b = near_pairs(position, radii, system.reach)
    pairs = [(a, b, np.linalg.norm(position[a] - position[b], axis=1) - radii[a] - radii[b])]
    for wall in system.walls:
        gap = wall.shape.signed_distance(position) - radii
        a = np.flatnonzero(gap <= system.reach)
        pairs.append((a, np.full_like(a, wall.surface), gap[a]))
    return _Near(*(np.concatenate(columns) for columns in zip(*pairs, strict=True)))


def _not_found(system: System, pose: Pose, near: _Near, error: float, count: int) -> IntArray:
    """Rows of pairs that the detector did not find: first those of round surfaces, which it had to find, then others,
    drawn by ``count``."""
    found = _without_images(detect(system, pose, None, system.reach))
    numbers = len(system.surfaces)
    is_found = np.isin(near.first * numbers + near.second, found.body_a * numbers + found.body_b)
    within = near.gap <= system.reach - error * system.bounding_radii.max(initial=0.0)
    missed = np.random.default_rng(count).permutation(np.flatnonzero(within & ~is_found))
    ball = np.append(system.balls, True)
    both_round = ball[near.first] & ball[np.minimum(near.second, len(system.bodies))]
    return np.asarray(missed[np.argsort(~both_round[missed], kind="stable")][:MOST_PAIRS])


def _side(system: System, pose: Pose, mesh: Mesh | None, number: int, error: float) -> _Side:
    """Surface of this number; a contact point lies off it by an ``error`` [length] and by as much as facets do."""
    count, d = len(system.bodies), system.dimension
    if number < count:
        rotation = rotation_matrices(pose.orientation[number : number + 1])[0]
        side = _Side(number, system.bodies[number], pose.position[number], rotation, error)
    else:
        side = _Side(number, system.domain.pieces[number - count].shape, np.zeros(d), np.eye(d), error)
    if mesh is None or not system.detection.on_mesh:
        return side
    middles = mesh.points[mesh.facets[mesh.markers == number]].mean(axis=1)
    there = mesh.ranks.greatest(len(middles)) > 0
    depth = mesh.ranks.greatest(np.abs(side.distance(middles)).max(initial=0.0)) if there else np.inf
    return side._replace(off=error + float(depth))


def _searched(a: _Side, b: _Side) -> tuple[float, FloatArray]:
    """Distance of two points of both surfaces, that of the surfaces where they are convex; 0 or below where they
    overlap [length]; and the point (1, d) of the second."""
    samples = a.samples()
    distance = b.distance(samples)
    point = samples[[int(np.argmin(distance))]]
    if distance.min() <= 0.0:
        return 0.0, point
    for _ in range(_PROJECTIONS):
        foot = b.closest(point)
        point = a.closest(foot)
    return float(np.linalg.norm(point - foot)), foot


def _pieces_meet(system: System, side: _Side, foot: FloatArray) -> bool:
    """Tell whether the side is a wall, and its point ``foot`` (1, d) on the next piece of the boundary too."""
    number = side.number - len(system.bodies)
    others = (piece.shape for i, piece in enumerate(system.domain.pieces) if i != number)
    return number >= 0 and any(abs(float(other.signed_distance(foot)[0])) <= side.off for other in others)
