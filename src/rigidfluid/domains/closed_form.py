"""CAD faces of a form that is known: planes, and all that is as far as its radius from a point, a line or a circle."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.surface import Plane

_EXACT = 1e-9
"""Distance of a face's samples from a form over the form's size, up to which the face has the form [1]."""

_SAMPLES = ((0.0, 0.0), (0.7, 0.2), (-1.1, 0.6), (2.3, -0.4), (0.1, 1.3))
"""Parameters u and v at which a face is looked at."""


@dataclass(frozen=True)
class Offset:
    """All points at the distance ``radius`` from a core: of a point a ball, of a line a cylinder, of a circle a torus.

    ``core`` gives the points of the core nearest to points (N, d); ``least_radius`` is the least radius of curvature.
    """

    core: Callable[[FloatArray], FloatArray]
    radius: float
    least_radius: float
    round: bool = False
    """Tell whether the core is a point."""

    def closest_point(self, points: FloatArray) -> FloatArray:
        """c + r (x - c)/|x - c| with the nearest point c of the core, (N, d)."""
        return self.core(points) + self.radius * self.outward(points)

    def outward(self, points: FloatArray) -> FloatArray:
        """(x - c)/|x - c|, unit vectors away from the core, (N, d)."""
        away = points - self.core(points)
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        return np.asarray(np.where(distance > 0.0, away / np.maximum(distance, 1e-300), np.eye(1, points.shape[1])))


@dataclass(frozen=True)
class Flat:
    """A ``plane``, or a straight line in 2D."""

    plane: Plane
    least_radius: float = np.inf

    def closest_point(self, points: FloatArray) -> FloatArray:
        """(N, d)."""
        return self.plane.closest_point(points)

    def outward(self, points: FloatArray) -> FloatArray:
        """The plane's normal, (N, d)."""
        return self.plane.normal(points)


Form = Flat | Offset


def form_of_face(surface: Any, unit: float = 1.0) -> Form | None:
    """The form of a face's ``surf`` in Netgen's OpenCASCADE, where ``unit`` is 1 [length]; None if it is none of those.

    The parametrisations are those of Open CASCADE: with axes X, Y and Z, a plane is O + uX + vY, a cylinder O + Re(u) +
    vZ, a ball O + R cos v e(u) + R sin v Z and a torus O + (R + r cos v) e(u) + r sin v Z, where e(u) = cos u X + sin u
    Y. So derivatives at u = v = 0 say what each would be, and other points whether it is.
    """
    from netgen import occ

    try:
        start, du, dv = (unit * components(one) for one in surface.D1(0.0, 0.0))
        samples = unit * np.array([components(surface.Value(u, v)) for u, v in _SAMPLES])
    except (occ.OCCException, RuntimeError):  # the surface has no such parameters
        return None
    size = float(np.ptp(samples, axis=0).max())
    for form in _guesses(start, du, dv):
        if np.all(np.abs(form.closest_point(samples) - samples) <= _EXACT * size):
            return form
    return None


def form_of_edge(edge: Any, unit: float = 1.0) -> Form | None:
    """The form of an edge in the plane z = 0, where ``unit`` is 1 [length]: a straight line, a circle, or None."""
    low, high = edge.parameter_interval
    samples = unit * np.array([components(edge.Value(t))[:2] for t in np.linspace(low, high, 6)[:5]])
    size = float(np.ptp(samples, axis=0).max())
    for form in _guesses_in_the_plane(*samples[[0, 1, 3]]):
        if np.all(np.abs(form.closest_point(samples) - samples) <= _EXACT * size):
            return form
    return None


def _guesses(start: FloatArray, du: FloatArray, dv: FloatArray) -> Iterator[Form]:
    around, along = float(np.linalg.norm(du)), float(np.linalg.norm(dv))
    if min(around, along) == 0.0:
        return
    y, z = du / around, dv / along
    if abs(y @ z) > _EXACT:
        return
    x = np.cross(y, z)
    yield Flat(Plane(start, x))
    for outward in (x, -x):
        centre = start - around * outward
        yield Offset(partial(_on_line, start=centre, along=z), around, around)
        yield Offset(partial(_on_point, point=centre), around, around, round=True)
        middle = around - along  # of a torus, from the axis to the middle of the tube
        if middle > along:
            core = partial(_on_circle, centre=centre, axis=z, radius=middle)
            yield Offset(core, along, min(along, middle - along))


def _guesses_in_the_plane(a: FloatArray, b: FloatArray, c: FloatArray) -> Iterator[Form]:
    (ux, uy), (vx, vy) = b - a, c - a
    length, twice = float(np.hypot(ux, uy)), 2.0 * float(ux * vy - uy * vx)
    if length == 0.0:
        return
    yield Flat(Plane(a, np.array([-uy, ux]) / length))
    if twice != 0.0:
        u, v = ux * ux + uy * uy, vx * vx + vy * vy
        centre = a + np.array([vy * u - uy * v, ux * v - vx * u]) / twice
        radius = float(np.linalg.norm(a - centre))
        yield Offset(partial(_on_point, point=centre), radius, radius, round=True)


def _on_point(points: FloatArray, point: FloatArray) -> FloatArray:
    return np.tile(point, (len(points), 1))


def _on_line(points: FloatArray, start: FloatArray, along: FloatArray) -> FloatArray:
    return np.asarray(start + np.outer((points - start) @ along, along))


def _on_circle(points: FloatArray, centre: FloatArray, axis: FloatArray, radius: float) -> FloatArray:
    away = points - centre
    away -= np.outer(away @ axis, axis)
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    return np.asarray(centre + radius * away / np.maximum(distance, 1e-300))


def components(vector: Any) -> FloatArray:
    """(3,)."""
    return np.array([vector.x, vector.y, vector.z])
