"""Dense swarms: bodies start small, grow, and push each other apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose
from rigidfluid.core.seeding.clearance import Clearance, Surroundings
from rigidfluid.core.seeding.relaxation import Relaxation
from rigidfluid.core.seeding.scaled_body import ScaledBody

_GROWTH, _LEAST_GROWTH = 0.05, 0.002
"""Relative growth of lengths between two relaxations, at first and at least."""

_MARGIN = 0.005
"""Part of the smallest bounding radius by which gaps are aimed wider than they must be, so that they get there soon."""


@dataclass(frozen=True)
class Growth:
    """Growth of ``bodies`` to their size among ``others``, which stay where they are, with at least a ``gap``.

    Lengths of the bodies and the gap grow together. ``turning`` tells whether bodies rotate.

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

    def grown(self, pose: Pose, scale: float) -> tuple[Pose, float]:
        """The pose of bodies and others at the largest size that is reached, over the full one, from a pose at which
        bodies of the size ``scale`` have their gaps."""
        growth = _GROWTH
        while scale < 1.0 and growth > _LEAST_GROWTH:
            larger = min(scale * (1.0 + growth), 1.0)
            found = self._relaxed(pose, larger)
            if found is None:
                growth *= 0.5
            else:
                pose, scale = found, larger
        return pose, scale

    def _relaxed(self, pose: Pose, scale: float) -> Pose | None:
        bodies = [ScaledBody(body, scale) for body in self.bodies]
        radii = np.array([body.bounding_radius for body in bodies])
        clearance = Clearance([*bodies, *self.others], len(bodies), self.around)
        least = scale * self.gap
        return Relaxation(clearance, radii, least + _MARGIN * float(radii.min()), least, self.turning)(pose)
