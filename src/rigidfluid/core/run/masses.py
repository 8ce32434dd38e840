"""Kinetic energies of free motions: with a velocity, or after an impulse."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.time_scheme import generalised_mass
from rigidfluid.core.model.state import State
from rigidfluid.core.model.system import System


class Masses:
    """Kinetic energies of the free motions at a ``time``, where the ``state`` has them."""

    def __init__(self, system: System, time: float, state: State) -> None:
        motions = system.motions
        self._free, self._mass = ~motions.prescribed, motions.mass[~motions.prescribed]
        self._matrix = generalised_mass(motions.mass, motions.inertia(time), state.motions.pose)[self._free]

    def energies(self, twist: FloatArray) -> FloatArray:
        """½ u·Mu of each of the ``twist`` (N, d+k) [energy]."""
        free = twist[self._free]
        return np.asarray(0.5 * np.einsum("ni,nij,nj->n", free, self._matrix, free))

    def energies_by(self, impulse: FloatArray) -> FloatArray:
        """Kinetic energy ½ J·M⁻¹J that each ``impulse`` J (N, d+k) gives a motion at rest [energy]."""
        free = impulse[self._free]
        return np.asarray(0.5 * np.sum(free * np.linalg.solve(self._matrix, free[..., None])[..., 0], axis=1))

    def fastest(self, energies: FloatArray) -> float:
        """The greatest of the speeds √(2E/m) of these kinetic energies [length/time]."""
        return float(np.sqrt(2.0 * energies / self._mass).max(initial=0.0))
