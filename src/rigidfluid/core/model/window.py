"""The part of a long domain that is meshed: it goes along an axis with one of the bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.types import Pose

CLEARANCE = 2.0
"""The centre of a body stays so many of its bounding radii away from an end of the window: nearer, the cells between
them are squeezed flat, and the open end is no channel that goes on."""


@dataclass(frozen=True)
class Window:
    """The part of a ``domain`` between two planes across an ``axis``.

    It reaches from ``behind`` to ``ahead`` at the start (coordinates along the axis) [length]. It has the displacement
    of the ``body``, which was at ``start`` [length], towards ``ahead``: no farther than to the end of the domain, and
    never back behind where it was at the start. So where it is follows from the bodies' pose alone.
    """

    domain: Domain
    body: int
    axis: int
    start: float
    behind: float
    ahead: float

    @property
    def sign(self) -> float:
        """Sign of the direction ahead along the axis."""
        return float(np.sign(self.ahead - self.behind))

    @property
    def way(self) -> float:
        """Distance that it can go until it reaches the end of the domain [length]."""
        return self.sign * (self._end - self.ahead)

    @property
    def ends(self) -> tuple[int, int]:
        """The pieces of the domain's boundary that are its ends, behind and ahead: numbers among the pieces."""
        planes = [piece.shape.plane for piece in self.domain.pieces]
        across = {
            float(plane.unit_normal[self.axis]): number
            for number, plane in enumerate(planes)
            if plane is not None and plane.axis == self.axis
        }
        return across[self.sign], across[-self.sign]

    def displacement(self, pose: Pose) -> float:
        """Displacement along the axis since the start, while the bodies are at ``pose`` [length]."""
        gone = self.sign * float(pose.position[self.body, self.axis] - self.start)
        return self.sign * min(max(gone, 0.0), self.way)

    def interval(self, pose: Pose) -> tuple[float, float]:
        """Lower and upper coordinate along the axis, while the bodies are at ``pose`` [length]."""
        moved = self.displacement(pose)
        ahead = self._end if abs(moved) == self.way else self.ahead + moved  # there to the last bit
        lower, upper = sorted((self.behind + moved, ahead))
        return lower, upper

    def meshed_domain(self, pose: Pose) -> Domain:
        """The part of the domain that is meshed while the bodies are at ``pose``."""
        part = self.domain.between(self.axis, *self.interval(pose))
        assert part is not None, "no window is made of a domain that has no parts"
        return part

    def left_by(self, pose: Pose, radius: FloatArray) -> int | None:
        """The first body, of bounding ``radius`` (n,), that is less than its clearance from an end at ``pose``, if any;
        an end that is the domain's own may be touched."""
        lower, upper = (float(corner[self.axis]) for corner in self.domain.extent)
        low, high = self.interval(pose)
        along, apart = pose.position[:, self.axis], CLEARANCE * radius
        left = ((along - apart < low) & (low > lower)) | ((along + apart > high) & (high < upper))
        return int(np.argmax(left)) if left.any() else None

    @property
    def _end(self) -> float:
        """End of the domain ahead along the axis [length]."""
        lower, upper = self.domain.extent
        return float((upper if self.sign > 0.0 else lower)[self.axis])
