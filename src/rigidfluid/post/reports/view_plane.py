"""The plane that pictures show: in 2D all there is, in 3D the plane of gravity, or of the stream, and of the motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import Results
from rigidfluid.post.reports.stream import prescribed_stream

PlaneName = Literal["motion", "xy", "xz", "yz"]

_STILL = 1e-2
"""Least spread of positions across a line, over the largest bounding radius, that counts as motion across it."""
_FLAT = 0.1
"""Largest spread of positions across a plane, over that along it, with which they lie in the plane."""
_ALONG_AN_AXIS = 0.02
"""The sine of the angle below which a direction is taken to be that of an axis."""


@dataclass(frozen=True)
class ViewPlane:
    """The directions (d,) that go to the ``right`` and ``up`` in a picture: unit vectors at right angles."""

    right: FloatArray
    up: FloatArray

    @classmethod
    def coordinate_plane(cls, right: int, up: int, dimension: int) -> ViewPlane:
        """Plane of two coordinate axes, by their numbers."""
        return cls(np.eye(dimension)[right], np.eye(dimension)[up])

    @property
    def normal(self) -> FloatArray:
        """Unit normal (3,) to the observer, in 3D."""
        return np.asarray(np.cross(self.right, self.up))

    @property
    def labels(self) -> tuple[str, str]:
        """Labels of the picture's axes."""
        return direction_label(self.right), direction_label(self.up)

    @property
    def words(self) -> str:
        """The plane's name."""
        names = [_axis_name(direction) for direction in (self.right, self.up)]
        if None not in names:
            return f"{names[0]}{names[1]}-plane"
        return f"plane across ({_numbers(self.normal)})"

    def flat(self, vectors: FloatArray) -> FloatArray:
        """Components of ``vectors`` (…, d) to the right and up, (…, 2)."""
        return np.asarray(vectors @ np.stack([self.right, self.up], axis=1))

    def lifted(self, flat: FloatArray, through: FloatArray) -> FloatArray:
        """The points (…, d) of the plane through a point (d,) that are at ``flat`` (…, 2) to the right and up."""
        off = through - self.right * (self.right @ through) - self.up * (self.up @ through)
        return np.asarray(flat @ np.stack([self.right, self.up]) + off)

    def extent(self, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Corners (2,) of the rectangle around a box, given by its corners (d,)."""
        corners = np.stack(np.meshgrid(*zip(lower, upper, strict=True)), axis=-1).reshape(-1, len(lower))
        seen = self.flat(corners)
        return seen.min(axis=0), seen.max(axis=0)


def view_plane(results: Results, name: PlaneName = "motion") -> ViewPlane:
    """Plane of that name, ``motion`` that of `plane_of_motion`; raises OutputError for another than xy in 2D."""
    if results.system.dimension == 2:
        if name not in ("motion", "xy"):
            raise OutputError("--plane", name, "xy, since the run is in 2D", "Leave it out.")
        return ViewPlane.coordinate_plane(0, 1, 2)
    if name == "motion":
        return plane_of_motion(results)
    return ViewPlane.coordinate_plane("xyz".index(name[0]), "xyz".index(name[1]), 3)


def plane_of_motion(results: Results) -> ViewPlane:
    """The plane of gravity and of the bodies' motion across it; without gravity that of the prescribed stream, without
    a stream that of the motion alone.

    Bodies that all keep to one such plane are seen in it, whatever its direction. If they spread over space, or do not
    move across, the picture has that axis to the right along which they move furthest, or the domain is longest. Axes
    are chosen so that gravity's goes up, and a stream to the right.
    """
    if results.system.dimension == 2:
        return ViewPlane.coordinate_plane(0, 1, 2)
    gravity = np.asarray(results.model.gravity or np.zeros(3), dtype=float)
    stream = prescribed_stream(results) if results.system.has_fluid else None
    if gravity.any():
        up = _snapped(-gravity)
        return _oriented(_across(results, up), up, rises=True)
    if stream is not None and stream.any():
        along = _snapped(stream)
        return _oriented(along, _across(results, along), rises=False)
    along = _main_motion(results)
    right, up = sorted((along, _across(results, along)), key=lambda direction: int(np.argmax(np.abs(direction))))
    return _oriented(right, up, rises=False)


def _main_motion(results: Results) -> FloatArray:
    """The direction along which positions spread most, the longest axis if nothing moves."""
    spread, directions = _spread(results, np.eye(3))
    if spread[-1] < _least_spread(results):
        return np.asarray(np.eye(3)[int(np.argmax(results.system.domain.size))])
    return _snapped(directions[:, -1])


def _across(results: Results, along: FloatArray) -> FloatArray:
    """The direction at right angles to ``along`` (3,) that makes a plane with it."""
    across = np.eye(3) - np.outer(along, along)
    spread, directions = _spread(results, across)
    moves = spread[-1] >= _least_spread(results)
    if moves and spread[-2] < _FLAT * spread[-1]:
        return _snapped(directions[:, -1])
    length = np.ptp(_positions(results), axis=0) if moves else results.system.domain.size
    free = np.linalg.norm(across, axis=1)
    axis = int(np.argmax(np.where(free > 0.5, length, -1.0)))
    return np.asarray(across[axis] / free[axis])


def _spread(results: Results, across: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Standard deviations of positions, projected by ``across`` (3, 3), from small to large, and their directions."""
    seen = _positions(results) @ across
    away = seen - seen.mean(axis=0)
    values, directions = np.linalg.eigh(away.T @ away / len(away))
    return np.sqrt(np.maximum(values, 0.0)), directions


def _positions(results: Results) -> FloatArray:
    """Positions of all bodies at all states in which they are there, (N, 3); one without bodies."""
    return np.asarray(results.quantity("position")[results.present] if results.names else np.zeros((1, 3)))


def _least_spread(results: Results) -> float:
    return _STILL * float(results.system.bounding_radii.max(initial=0.0)) or np.inf


def _oriented(right: FloatArray, up: FloatArray, *, rises: bool) -> ViewPlane:
    """The plane of both directions, shown by coordinate axes where its normal is one of them.

    Otherwise ``up`` is kept where it ``rises``, which gravity tells, and ``right`` has its largest component positive.
    """
    normal = _snapped(np.cross(right, up))
    if np.count_nonzero(normal) == 1:
        first, second = np.abs(right), np.abs(up)
        axes = [axis for axis in range(3) if normal[axis] == 0.0]
        upper = max(axes, key=lambda axis: second[axis] - first[axis])
        axes.remove(upper)
        return ViewPlane.coordinate_plane(axes[0], upper, 3)
    right = right if right[np.argmax(np.abs(right))] > 0.0 else -right
    up = up if rises or up[np.argmax(np.abs(up))] > 0.0 else -up
    return ViewPlane(right, up)


def _snapped(direction: FloatArray) -> FloatArray:
    """The unit vector, along the nearest axis if that is near."""
    unit = direction / np.linalg.norm(direction)
    axis = int(np.argmax(np.abs(unit)))
    if np.linalg.norm(np.delete(unit, axis)) >= _ALONG_AN_AXIS:
        return np.asarray(unit)
    return np.asarray(np.sign(unit[axis]) * np.eye(3)[axis])


def direction_label(direction: FloatArray) -> str:
    """Label of an axis in that direction (d,)."""
    name = _axis_name(direction)
    return f"{name} [length]" if name else f"along ({_numbers(direction)}) [length]"


def _axis_name(direction: FloatArray) -> str | None:
    axis = int(np.argmax(direction))
    return "xyz"[axis] if direction[axis] == 1.0 else None


def _numbers(direction: FloatArray) -> str:
    return ", ".join(f"{part + 0.0:.2g}" for part in np.round(direction, 3))
