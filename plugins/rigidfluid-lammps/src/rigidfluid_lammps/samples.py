"""Samples of both programs' bodies at common times, and the energy and momentum of those."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rigidfluid.api import FloatArray


class Sample(NamedTuple):
    """The bodies at one moment.

    ``position``, ``velocity`` (n, d), ``spin`` (n, k), energy ``stored`` in the contacts, and ``wall_force`` (w,), how
    hard each wall is pushed outwards.
    """

    position: FloatArray
    velocity: FloatArray
    spin: FloatArray
    stored: float
    wall_force: FloatArray


@dataclass(frozen=True)
class Samples:
    """Samples of one program: ``time`` (s,) and the arrays of `Sample`, with s as the first axis."""

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    spin: FloatArray
    stored: FloatArray
    wall_force: FloatArray

    @classmethod
    def stack(cls, time: FloatArray, samples: Sequence[Sample]) -> Samples:
        """The samples at these times (s,) [time]."""
        return cls(time, *(np.array(values, dtype=float) for values in zip(*samples, strict=True)))

    def energy(self, mass: FloatArray, inertia: FloatArray) -> FloatArray:
        """Σ ½ m|U|² + ½ J|ω|² + stored, (s,), for ``mass`` m and ``inertia`` J (n,) [energy]."""
        moving = mass * np.sum(self.velocity**2, axis=2) + inertia * np.sum(self.spin**2, axis=2)
        return np.asarray(0.5 * moving.sum(axis=1) + self.stored)

    def momentum(self, mass: FloatArray) -> FloatArray:
        """Σ m U, (s, d) [mass·length/time]."""
        return np.asarray(np.einsum("n,snd->sd", mass, self.velocity))
