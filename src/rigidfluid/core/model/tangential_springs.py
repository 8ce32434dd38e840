"""Springs along the surfaces of contacts, which friction holds and shortens: the memory of static friction."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class TangentialSprings:
    """Springs along the surfaces of s contacts, between the surfaces ``body_a`` and ``body_b`` (s,).

    ``displacement`` ξ (s, d): of a relative to b since they stick, less what slipped, across the ``normal`` (s, d)
    [length]; ``stiffness`` k (s,) [force/length]. ``turning`` ζ (s, k): so for rolling and twisting, the relative angle
    times the effective radius, zero without springs that resist these [length]. ``arm_a``, ``arm_b`` (s, d): contact
    points in the frames of their bodies, from the centres of mass, and those on walls themselves [length].
    """

    body_a: IntArray
    body_b: IntArray
    arm_a: FloatArray
    arm_b: FloatArray
    normal: FloatArray
    displacement: FloatArray
    stiffness: FloatArray
    turning: FloatArray

    def __len__(self) -> int:
        return len(self.stiffness)

    @property
    def energy(self) -> FloatArray:
        """k (ξ² + ζ²)/2, (s,) [energy]."""
        square = np.sum(self.displacement**2, axis=1) + np.sum(self.turning**2, axis=1)
        return np.asarray(0.5 * self.stiffness * square)

    def select(self, chosen: IntArray | BoolArray) -> TangentialSprings:
        """Springs in the rows ``chosen``, (k,) numbers in the order wanted or (s,) truth values."""
        return TangentialSprings(*(getattr(self, field.name)[chosen] for field in fields(self)))


def spring_energy(springs: TangentialSprings | None) -> float:
    """Energy of all springs, zero without any [energy]."""
    return 0.0 if springs is None else float(springs.energy.sum())
