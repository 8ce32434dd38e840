"""Frames that bodies carry, or that stand on the ground: what joints compare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.kinematics import levers
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.types import Pose


@dataclass(frozen=True, slots=True)
class Marker:
    """A point and axes fixed to a ``body``, or to the ground where that is None.

    ``point`` (d,): from the body's centre of mass, in its frame [length]; ``axes`` (d, d): columns, in its frame [1];
    ``start``: the body's angle at the start in 2D [rad], 0 on the ground and in 3D.
    """

    body: int | None
    point: FloatArray
    axes: FloatArray
    start: float


def marker(body: int | None, point: FloatArray, axes: FloatArray, pose: Pose) -> Marker:
    """Marker on a body of ``pose``, where ``point`` (d,) and ``axes`` (d, d) of space are now."""
    if body is None:
        return Marker(None, point, axes, 0.0)
    rotation = rotation_matrices(pose.orientation[body : body + 1])[0]
    start = float(pose.orientation[body, 0]) if len(point) == 2 else 0.0
    return Marker(body, rotation.T @ (point - pose.position[body]), rotation.T @ axes, start)


@dataclass(frozen=True, slots=True)
class MarkerPair:
    """Two markers that are one at the start."""

    first: Marker
    second: Marker

    @property
    def bodies(self) -> tuple[int | None, int | None]:
        """Bodies that carry the markers, None for the ground."""
        return self.first.body, self.second.body

    @property
    def spins(self) -> int:
        """Number k of rotations."""
        return 1 if len(self.first.point) == 2 else 3


class PlacedPair(NamedTuple):
    """A pair in space, in one pose: ``points`` (2, d) [length], ``axes`` (2, d, d), ``levers`` (2, d, k) of the points
    about the centres of mass, see `levers` [length]; ``turned`` (2,): in 2D by how much the bodies have turned, whole
    turns included [rad]."""

    points: FloatArray
    axes: FloatArray
    levers: FloatArray
    turned: FloatArray

    @property
    def gap(self) -> FloatArray:
        """Vector from the second point to the first one (d,) [length]."""
        return np.asarray(self.points[0] - self.points[1])

    @property
    def angle(self) -> float:
        """Angle of the first marker seen from the second, about the last axis, zero at the start [rad]; in 2D whole
        turns included, in 3D in (-π, π]."""
        if self.levers.shape[-1] == 1:
            return float(self.turned[0] - self.turned[1])
        first, second = self.axes
        return atan2(float(first[:, 0] @ second[:, 1]), float(first[:, 0] @ second[:, 0]))

    @property
    def levers_at_first(self) -> FloatArray:
        """Levers (2, d, k) of the first point about both centres of mass: with the second, the velocity is that of the
        second body where the first point is [length]."""
        return np.stack([self.levers[0], self.levers[1] + levers(self.gap[None])[0]])

    @property
    def spin_axis(self) -> FloatArray:
        """Axis about which the angle is counted (k,) [1]."""
        return np.ones(1) if self.levers.shape[-1] == 1 else self.axes[1][:, 2]


class Markers:
    """Pairs of markers on bodies of ``dimension`` d, to be placed together."""

    def __init__(self, pairs: Sequence[MarkerPair], dimension: int) -> None:
        markers, d = [one for pair in pairs for one in (pair.first, pair.second)], dimension
        self._body = np.array([-1 if one.body is None else one.body for one in markers], dtype=np.int64)
        self._point = np.array([one.point for one in markers]).reshape(-1, d)
        self._axes = np.array([one.axes for one in markers]).reshape(-1, d, d)
        self._start = np.array([one.start for one in markers])
        self._latest: tuple[Pose, list[PlacedPair]] | None = None

    @property
    def reach(self) -> float:
        """Greatest distance of the points from the origins of their frames [length]."""
        return float(np.linalg.norm(self._point, axis=1).max(initial=0.0))

    def placed(self, pose: Pose) -> list[PlacedPair]:
        """Place all pairs, in their order, at the bodies' ``pose``; those at the latest pose are kept."""
        if self._latest is None or self._latest[0] is not pose:
            self._latest = pose, self._placed(pose)
        return self._latest[1]

    def _placed(self, pose: Pose) -> list[PlacedPair]:
        d = self._point.shape[1]
        rotation = np.concatenate([rotation_matrices(pose.orientation), np.eye(d)[None]])[self._body]
        centre = np.concatenate([pose.position, np.zeros((1, d))])[self._body]
        arms = np.einsum("mij,mj->mi", rotation, self._point)
        turned = np.append(pose.orientation[:, 0], 0.0)[self._body] - self._start
        placed = centre + arms, rotation @ self._axes, levers(arms), turned
        return [
            PlacedPair(*each) for each in zip(*(rows.reshape(-1, 2, *rows.shape[1:]) for rows in placed), strict=True)
        ]


def add_relative_rows(
    bodies: tuple[int | None, int | None], at: FloatArray, directions: tuple[FloatArray, FloatArray], rows: FloatArray
) -> None:
    """Add rows E (v₁ - v₂) + A (ω₁ - ω₂) on the twists of two ``bodies`` to ``rows`` (r, n, d+k); ``directions``: E
    (r, d) and A (r, k), ``at``: levers (2, d, k) of the points whose velocities v are."""
    along, about = directions
    for sign, body, lever in zip((1.0, -1.0), bodies, at, strict=True):
        if body is not None:
            rows[:, body] += sign * np.concatenate([along, along @ lever + about], axis=1)


def axes_along(axis: FloatArray) -> FloatArray:
    """Right-handed axes (d, d), columns, the last of them along a unit vector (d,)."""
    if len(axis) == 2:
        return np.array([[axis[1], axis[0]], [-axis[0], axis[1]]])
    side = np.eye(3)[int(np.argmin(np.abs(axis)))]
    across = side - (side @ axis) * axis
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(axis, across), axis], axis=1)
