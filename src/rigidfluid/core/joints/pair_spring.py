"""Long-range force between two bodies, as a spring that stores its energy in their poses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.mechanics.wrenches import add_pair_wrench
from rigidfluid.core.model.pose_law import PairPoses, PoseLaw
from rigidfluid.core.model.types import Pose, Wrench


@dataclass(frozen=True, slots=True)
class PairSpring:
    """Force by a ``law`` between the bodies ``first`` and ``second``, whose centres of mass come no nearer than
    ``closest`` [length]."""

    law: PoseLaw
    first: int
    second: int
    closest: float

    def energy(self, pose: Pose) -> float:
        return float(self.law.pair_energy(self._pair(pose))[0])

    def add_wrench(self, pose: Pose, wrench: Wrench) -> None:
        pair = self._pair(pose)
        force, couple = self.law.pair_force(pair)[0], self.law.pair_couple(pair)[0]
        add_pair_wrench(wrench, pose, (self.first, self.second), force, couple)

    def stretch(self, pose: Pose) -> FloatArray:
        """Rows of a bound of the energy's second derivative, at any distance the bodies may come to."""
        straight, turning = self.law.pair_stiffness(np.array([self.closest]))[0]
        count, d = pose.position.shape
        k = 1 if d == 2 else 3
        rows = np.zeros((d + 2 * k, count, d + k))
        rows[:d, self.first, :d], rows[:d, self.second, :d] = (
            np.sqrt(straight) * np.eye(d),
            -np.sqrt(straight) * np.eye(d),
        )
        rows[d : d + k, self.first, d:] = rows[d + k :, self.second, d:] = np.sqrt(turning) * np.eye(k)
        return rows

    def _pair(self, pose: Pose) -> PairPoses:
        ends = [self.first, self.second]
        rotations = rotation_matrices(pose.orientation[ends])
        return PairPoses((pose.position[self.first] - pose.position[self.second])[None], rotations[:1], rotations[1:])
