"""Dense swarms: bodies start small, grow, and push each other apart; where they are stuck, they are shaken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose
from rigidfluid.core.seeding.clearance import Clearance, Surroundings
from rigidfluid.core.seeding.draws import Draws
from rigidfluid.core.seeding.relaxation import Relaxation
from rigidfluid.core.seeding.scaled_body import ScaledBody

_GROWTH, _LEAST_GROWTH = 0.05, 0.002
"""Relative growth of lengths between two relaxations, at first and at least."""

_STEPS = 200
"""Steps of a relaxation after the first growth; a slower one may take longer in proportion, as it is nearer the end."""

_MARGIN = 0.005
"""Part of the smallest bounding radius by which gaps are aimed wider than they must be, so that they get there soon."""


_NEAR, _CYCLES, _SHAKES = 0.95, 8, 20
"""Size over the full one from which on it is worth to shake stuck bodies, how often they shrink and grow again, and
shakes in between."""

_SHRUNK, _SHAKE = 0.03, 0.2
"""Relative loss of size before they are shaken, and standard deviation of each component of their displacement over the
bounding radius [1]."""


@dataclass(frozen=True)
class Growth:
    """Growth of ``bodies`` to their size among ``others``, which stay where they are, with at least a ``gap``.

    Lengths of the bodies and the gap grow together. ``turning`` tells whether bodies rotate.
    Shaking moves bodies at random, by ``draws``, while they are a little smaller.

    Notes
    -----
    B. D. Lubachevsky and F. H. Stillinger, J. Stat. Phys. 60 (1990) 561, doi:10.1007/BF01025983, let disks grow while
    they collide; here they are at rest between relaxations.
    """

    bodies: Sequence[Body]
    others: Sequence[Body]
    around: Surroundings
    gap: float
    turning: bool
    draws: Draws

    def grown(self, pose: Pose, scale: float) -> tuple[Pose, float]:
        """The pose of bodies and others at the largest size that is reached, over the full one, from a pose at which
        bodies of the size ``scale`` have their gaps."""
        pose, scale = self._until_stuck(pose, scale)
        for _ in range(_CYCLES):
            if scale == 1.0 or scale < _NEAR:
                break
            smaller = (1.0 - _SHRUNK) * scale
            loose, reached = self._until_stuck(self._shaken(pose, smaller), smaller)
            if reached > scale:
                pose, scale = loose, reached
        return pose, scale

    def _until_stuck(self, pose: Pose, scale: float) -> tuple[Pose, float]:
        growth = _GROWTH
        while scale < 1.0 and growth > _LEAST_GROWTH:
            larger = min(scale * (1.0 + growth), 1.0)
            found = self._relaxed(pose, larger, round(_STEPS * _GROWTH / growth))
            if found is None:
                growth *= 0.5
            else:
                pose, scale = found, larger
        return pose, scale

    def _shaken(self, pose: Pose, scale: float) -> Pose:
        """A pose that several random displacements and relaxations lead to."""
        spread = _SHAKE * scale * np.array([body.bounding_radius for body in self.bodies])[:, None]
        for _ in range(_SHAKES):
            position = pose.position.copy()
            position[: len(spread)] += spread * self.draws.normal(len(spread), position.shape[1])
            pose = self._relaxed(Pose(position, pose.orientation), scale, 2 * _STEPS) or pose
        return pose

    def _relaxed(self, pose: Pose, scale: float, steps: int) -> Pose | None:
        bodies = [ScaledBody(body, scale) for body in self.bodies]
        radii = np.array([body.bounding_radius for body in bodies])
        clearance = Clearance([*bodies, *self.others], len(bodies), self.around)
        least = scale * self.gap
        wanted = least + _MARGIN * float(radii.min())
        return Relaxation(clearance, radii, wanted, least, self.turning, steps)(pose)
