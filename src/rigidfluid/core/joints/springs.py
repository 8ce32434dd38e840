"""Interface of springs, and springs between bodies and the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_between
from rigidfluid.core.model.types import Pose, Wrench


@runtime_checkable
class Spring(Protocol):
    """Stores energy in a pose of the n bodies."""

    def energy(self, pose: Pose) -> float:
        """Energy stored at the bodies' ``pose`` [energy]."""

    def add_wrench(self, pose: Pose, wrench: Wrench) -> None:
        """Add -d energy/d pose in place."""

    def stretch(self, pose: Pose) -> FloatArray:
        """Rows B (r, n, d+k) of d energy = ½ |B δ|², δ displacements from where nothing is stretched [√stiffness]."""


@dataclass(frozen=True, slots=True)
class GroundSpring:
    """½ Σ ``stiffness`` · displacement² of a body from ``position`` (d,) and ``orientation`` (q,) along the axes of
    space; of rotations in 3D the displacement is the rotation vector, of at most half a turn."""

    body: int
    stiffness: FloatArray
    position: FloatArray
    orientation: FloatArray

    def energy(self, pose: Pose) -> float:
        return 0.5 * float(self.stiffness @ self._displacement(pose) ** 2)

    def add_wrench(self, pose: Pose, wrench: Wrench) -> None:
        displaced, d = self._displacement(pose), len(self.position)
        load = -self.stiffness * displaced
        wrench.force[self.body] += load[:d]
        wrench.torque[self.body] += load[d:] if d == 2 else _inverse_left_jacobian(displaced[d:]).T @ load[d:]

    def stretch(self, pose: Pose) -> FloatArray:
        width = len(self.stiffness)
        rows = np.zeros((width, len(pose.position), width))
        rows[:, self.body] = np.diag(np.sqrt(self.stiffness))
        return rows

    def _displacement(self, pose: Pose) -> FloatArray:
        turned = rotation_between(self.orientation[None], pose.orientation[self.body : self.body + 1])[0]
        return np.concatenate([pose.position[self.body] - self.position, turned])


def _inverse_left_jacobian(turn: FloatArray) -> FloatArray:
    """J⁻¹ with log(exp(δ) exp(φ)) = φ + J⁻¹ δ for small δ: 1 - ½ [φ]× + (1 - ½θ cot ½θ)/θ² [φ]×², θ = |φ|."""
    half = 0.5 * float(np.linalg.norm(turn))
    skew = np.cross(np.eye(3), turn)
    bent = 1.0 / 12.0 if half < 1e-3 else (1.0 - half / np.tan(half)) / (4.0 * half**2)
    return np.asarray(np.eye(3) - 0.5 * skew + bent * skew @ skew)
