"""Velocities of walls that slide in themselves: straight on, or turning about a point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.geometry.curl import curl
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.rigid import cross

_STEP = 1e-3
"""Step of differences over the largest coordinate."""


@dataclass(frozen=True)
class WallVelocity:
    """Velocity field v + ω × (x - c): ``velocity`` v (d,) [length/time], ``angular_velocity`` ω (k,) [rad/time],
    ``centre`` c (d,) [length]."""

    velocity: FloatArray
    angular_velocity: FloatArray
    centre: FloatArray

    def __call__(self, points: FloatArray) -> FloatArray:
        """Velocity (N, d) at ``points`` (N, d) [length/time]."""
        if not self.angular_velocity.any():
            return np.tile(self.velocity, (len(points), 1))
        spin = np.tile(self.angular_velocity, (len(points), 1))
        return np.asarray(self.velocity + cross(spin, points - self.centre))


class SlidingWalls:
    """Velocities of all walls that slide, by surface number."""

    def __init__(self, walls: Sequence[Wall]) -> None:
        self._sliding = [(wall.surface, wall.velocity) for wall in walls if wall.velocity is not None]

    def __call__(self, surfaces: IntArray, points: FloatArray) -> FloatArray:
        """Velocity (m, d) of ``surfaces`` (m,) at ``points`` (m, d) of theirs, zero of all others [length/time]."""
        velocity = np.zeros_like(points)
        for surface, at in self._sliding:
            on = surfaces == surface
            velocity[on] = at(points[on])
        return velocity

    def angular_velocity(self, surfaces: IntArray, points: FloatArray) -> FloatArray:
        """Angular velocity (m, k) of ``surfaces`` (m,) at ``points`` (m, d) of theirs, half the curl of their velocity,
        zero of all others [rad/time]."""
        turning = np.zeros((len(points), 1 if points.shape[1] == 2 else 3))
        for surface, at in self._sliding:
            on = surfaces == surface
            turning[on] = 0.5 * curl(_slopes(at, points[on]))
        return turning


def _slopes(velocity: Callable[[FloatArray], FloatArray], points: FloatArray) -> FloatArray:
    """Slopes ∂v_i/∂x_j (N, d, d) at ``points`` (N, d) by central differences, exact for rigid motions [1/time]."""
    step = _STEP * np.abs(points).max(initial=0.0) or 1.0
    along = step * np.eye(points.shape[1])
    return np.stack([velocity(points + one) - velocity(points - one) for one in along], axis=-1) / (2.0 * step)
