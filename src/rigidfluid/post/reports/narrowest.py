"""Location of the narrowest gap of a body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Surface
from rigidfluid.post.reports.bodies import cut, seen_bodies
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.view_plane import ViewPlane

_ZOOMS, _POINTS = 6, 41
"""Number of refinements of an outline about its nearest point, and of points in each."""
_OFF = 0.1
"""Largest distance of the gap's middle from the plane, over the gap."""


@dataclass(frozen=True)
class _Placed:
    """A surface where it is: its frame turned by ``turn`` (d, d) about its origin, which is at ``centre`` (d,)."""

    surface: Surface
    centre: FloatArray
    turn: FloatArray

    def distance(self, points: FloatArray) -> FloatArray:
        return self.surface.signed_distance((points - self.centre) @ self.turn)

    def closest(self, points: FloatArray) -> FloatArray:
        return np.asarray(self.surface.closest_point((points - self.centre) @ self.turn) @ self.turn.T + self.centre)


def gap_middle(results: Results, state: int, number: int, plane: ViewPlane) -> FloatArray | None:
    """Middle (2,) of the shortest line from a body to another surface, to the right and up; None where the line does
    not lie in the ``plane`` through the body's centre, or the body is not there.

    The other surface is that whose distance agrees best with the table's gap, which is none to surfaces without wall.
    """
    if not results.present[state, number]:
        return None
    bodies, centre = seen_bodies(results, state), results.path(number)[state]
    body = min((one for one in bodies if one.number == number), key=lambda one: _apart(one.centre, centre))
    bodies.remove(body)
    curves = [curve[:-1] for curve in cut(body, plane, centre)]  # closed: the last point is the first
    outline = plane.lifted(np.concatenate(curves), centre)
    own = _Placed(body.shape, centre, body.turn)
    others = [_Placed(other.shape, other.centre, other.turn) for other in bodies]
    still = np.zeros(len(centre)), np.eye(len(centre))
    others += [_Placed(piece.shape, *still) for piece in results.system.domain.pieces]
    gap = float(results.bodies["gap"][state, number])
    lines = [_shortest_line(own, other, outline) for other in others]
    line = min(lines, key=lambda line: abs(float(np.linalg.norm(line[1] - line[0])) - gap))
    middle = line.mean(axis=0)
    off = middle - plane.lifted(plane.flat(middle), centre)
    return plane.flat(middle) if np.linalg.norm(off) <= _OFF * gap else None


def _apart(one: FloatArray, other: FloatArray) -> float:
    return float(np.linalg.norm(one - other))


def _shortest_line(own: _Placed, other: _Placed, outline: FloatArray) -> FloatArray:
    """From the point of the ``outline`` (K, d) that is nearest to the other surface, (2, d)."""
    points = np.roll(outline, len(outline) // 2 - int(np.argmin(other.distance(outline))), axis=0)
    for _ in range(_ZOOMS):
        nearest = int(np.clip(np.argmin(other.distance(points)), 1, len(points) - 2))
        points = own.closest(np.linspace(points[nearest - 1], points[nearest + 1], _POINTS))
    first = points[[int(np.argmin(other.distance(points)))]]
    return np.concatenate([first, other.closest(first)])
