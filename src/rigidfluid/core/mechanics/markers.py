"""Frames that bodies carry, or that stand on the ground: what joints compare."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2

import numpy as np

from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.types import FloatArray, Pose


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

    def placed(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """The point (d,) and the axes (d, d) in space."""
        if self.body is None:
            return self.point, self.axes
        rotation = rotation_matrices(pose.orientation[self.body : self.body + 1])[0]
        return pose.position[self.body] + rotation @ self.point, rotation @ self.axes

    def arm(self, pose: Pose) -> FloatArray:
        """From the body's centre of mass to the point (d,); zero on the ground, which has no moments [length]."""
        return np.zeros_like(self.point) if self.body is None else self.placed(pose)[0] - pose.position[self.body]

    def angle(self, pose: Pose) -> float:
        """In 2D by how much the body has turned since the start, whole turns included [rad]."""
        return 0.0 if self.body is None else float(pose.orientation[self.body, 0]) - self.start


def marker(body: int | None, point: FloatArray, axes: FloatArray, pose: Pose) -> Marker:
    """On a body that is now at ``pose``, where a ``point`` (d,) and ``axes`` (d, d) of space are now."""
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
    def spins(self) -> int:
        """k."""
        return 1 if len(self.first.point) == 2 else 3

    @property
    def reach(self) -> float:
        """How far their points are from where their frames have the origin [length]."""
        return float(max(np.linalg.norm(self.first.point), np.linalg.norm(self.second.point)))

    def gap(self, pose: Pose) -> FloatArray:
        """From the second point to the first one (d,) [length]."""
        return self.first.placed(pose)[0] - self.second.placed(pose)[0]

    def axes(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Of both in space (d, d)."""
        return self.first.placed(pose)[1], self.second.placed(pose)[1]

    def angle(self, pose: Pose) -> float:
        """Of the first seen from the second, about the last axis, zero at the start [rad]; in 2D whole turns included,
        in 3D in (-π, π]."""
        if self.spins == 1:
            return self.first.angle(pose) - self.second.angle(pose)
        first, second = self.axes(pose)
        return atan2(float(first[:, 0] @ second[:, 1]), float(first[:, 0] @ second[:, 0]))

    def spin_axis(self, pose: Pose) -> FloatArray:
        """About which the angle is counted (k,)."""
        return np.ones(1) if self.spins == 1 else self.axes(pose)[1][:, 2]


def axes_about(axis: FloatArray) -> FloatArray:
    """Right-handed axes (3, 3), columns, the last of them along a unit vector (3,)."""
    side = np.eye(3)[int(np.argmin(np.abs(axis)))]
    across = side - (side @ axis) * axis
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(axis, across), axis], axis=1)
