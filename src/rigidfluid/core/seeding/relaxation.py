"""Bodies push each other apart, until all gaps are as wide as they should be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray, IntArray
from rigidfluid.core.mechanics.rigid import moment, rotate
from rigidfluid.core.model.types import Pose
from rigidfluid.core.seeding.clearance import Clearance, Gaps

_STEP, _LONGEST = 0.1, 0.5
"""First and longest step, over the time √(m/k) of a body on the spring of one gap [1]."""

_MIXING, _LONGER, _SHORTER, _PATIENCE = 0.1, 1.1, 0.5, 5
"""Constants of FIRE: how strongly velocities turn to the force, factors of the step, and steps that go well before it
grows; the mixing falls by a hundredth in each of these."""

_FARTHEST = 0.1
"""Greatest displacement in one step, over the bounding radius [1]."""


@dataclass(frozen=True)
class Relaxation:
    """Descent of the energy Σ ½ (gap wanted - gap)² over all gaps that are too narrow, by FIRE.

    ``wanted`` is aimed at, and ``least`` is enough [length]. Bodies have mass 1 and inertia R², ``radii`` R (n,)
    [length]; ``turning`` tells whether they rotate. They count as stuck after a number of ``steps``.

    Notes
    -----
    E. Bitzek et al., Structural relaxation made simple, Phys. Rev. Lett. 97 (2006) 170201,
    doi:10.1103/PhysRevLett.97.170201.
    """

    clearance: Clearance
    radii: FloatArray
    wanted: float
    least: float
    turning: bool
    steps: int

    def __call__(self, start: Pose) -> Pose | None:
        """The pose at which no gap is below ``least``, those of bodies beyond n unchanged; None where it is stuck."""
        pose, count = start, len(self.radii)
        gaps = self.clearance.within(pose, self.wanted)
        spins = 1 if start.orientation.shape[1] == 1 else 3
        velocity = np.zeros((count, start.position.shape[1] + spins))
        step, mixing, good = _STEP, _MIXING, 0
        for _ in range(self.steps):
            if np.all(gaps.gap >= self.least):
                return pose
            force = self._force(gaps, pose)
            if np.sum(force * velocity) > 0.0:
                speed = np.sqrt(np.sum(velocity**2) / np.sum(force**2))
                velocity = (1.0 - mixing) * velocity + mixing * speed * force
                good += 1
                if good > _PATIENCE:
                    step, mixing = min(_LONGER * step, _LONGEST), 0.99 * mixing
            else:
                velocity[:] = 0.0
                step, mixing, good = max(_SHORTER * step, 0.1 * _STEP), _MIXING, 0
            velocity += step * force
            pose = self._moved(pose, step * velocity)
            gaps = self.clearance.within(pose, self.wanted)
        return None

    def _force(self, gaps: Gaps, pose: Pose) -> FloatArray:
        """Force, and torque over R, on each body (n, d + k) [length]."""
        count, dimension = len(self.radii), pose.position.shape[1]
        push = np.maximum(self.wanted - gaps.gap, 0.0)[:, None] * gaps.normal
        total = np.zeros((count, dimension + (1 if dimension == 2 else 3)))
        for body, point, sign in ((gaps.a, gaps.point_a, 1.0), (gaps.b, gaps.point_b, -1.0)):
            rows = np.flatnonzero((body >= 0) & (body < count))
            self._add(total, body[rows], point[rows], sign * push[rows], pose)
        return total

    def _add(self, total: FloatArray, body: IntArray, point: FloatArray, force: FloatArray, pose: Pose) -> None:
        dimension = force.shape[1]
        np.add.at(total[:, :dimension], body, force)
        if self.turning:
            torque = moment(point - pose.position[body], force) / self.radii[body, None]
            np.add.at(total[:, dimension:], body, torque)

    def _moved(self, pose: Pose, displacement: FloatArray) -> Pose:
        count, dimension = len(self.radii), pose.position.shape[1]
        far = np.linalg.norm(displacement, axis=1, keepdims=True) / (_FARTHEST * self.radii[:, None])
        displacement = displacement / np.maximum(far, 1.0)
        position, orientation = pose.position.copy(), pose.orientation.copy()
        position[:count] += displacement[:, :dimension]
        if self.turning:
            turn = displacement[:, dimension:] / self.radii[:, None]
            orientation[:count] = rotate(orientation[:count], turn)
        return Pose(position, orientation)
