"""Anchor of a motion where no inertia and no wall, but held fluxes alone say how fast fluid and bodies go.

One velocity of all then costs next to nothing in a step's matrix, so that no solver would find it: its only weight is
that of the bodies. A resistance to the translation of one motion, s (U - c) with a velocity c as another unknown, makes
the matrix regular; it takes no part where c = U, which is one more equation for the superposition of `driving`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.types import Links
from rigidfluid.errors import StepError
from rigidfluid.taylor_hood.elements.surfaces import Surfaces
from rigidfluid.taylor_hood.system.coupled import CoupledMatrix

_LIGHT, _LOST = 1e-3, 1e-6
"""Mass of all bodies over the time of a step and over the resistance, below which they are anchored [1]: for others the
solvers do; and below which their velocity is not to be had where no flux is held."""


@dataclass(frozen=True, eq=False)
class Anchor:
    """Resistance ``strength`` s [force·time/length] of the first motion along ``directions`` (c, d), of unit length."""

    strength: float
    directions: FloatArray

    def added_to(self, matrix: CoupledMatrix) -> CoupledMatrix:
        """A step's ``matrix`` with s Σ n nᵀ on the anchored motion."""
        d = self.directions.shape[1]
        mass_matrix = matrix.mass_matrix.copy()
        mass_matrix[0, :d, :d] += self.strength * self.directions.T @ self.directions
        return replace(matrix, mass_matrix=mass_matrix)

    def loads(self, body_load: FloatArray) -> list[FloatArray]:
        """Load s n of a unit velocity c along each direction, in the shape (N, d+k) of a ``body_load``."""
        loads = [np.zeros_like(body_load) for _ in self.directions]
        for load, direction in zip(loads, self.directions, strict=True):
            load[0, : len(direction)] = self.strength * direction
        return loads

    def velocities(self, twist: FloatArray) -> FloatArray:
        """Velocities (c,) of the anchored motion along the directions, of the motions' ``twist`` (N, d+k)."""
        return np.asarray(self.directions @ twist[:1, : self.directions.shape[1]].sum(axis=0))


def anchor(surfaces: Surfaces, matrix: CoupledMatrix, links: Links, normals: FloatArray) -> Anchor:
    """Anchor along the ``normals`` (c, d) of faces whose fluxes are held; along none where anything else holds all.

    The resistance is μ Lᵈ⁻², L the length of what is meshed. Raises StepError where the velocity of all along
    another direction is not to be had.
    """
    strength, d = _resistance(matrix), matrix.points.shape[1]
    if not is_adrift(surfaces, matrix, links):
        return Anchor(strength, normals[:0])
    if np.linalg.matrix_rank(normals) < d and is_adrift(surfaces, matrix, links, _LOST):
        raise adrift(f"flux on {len(normals)} of {d} pairs of surfaces")
    return Anchor(strength, normals)


def is_adrift(surfaces: Surfaces, matrix: CoupledMatrix, links: Links, share: float = _LIGHT) -> bool:
    """Tell whether there are bodies, all free, whose masses are below this ``share`` of the resistance, without inertia
    of the fluid and without walls."""
    d, free = matrix.points.shape[1], ~matrix.prescribed
    seams_alone = all(face.condition.is_seam for face in surfaces.faces)
    if matrix.inertia > 0.0 or not (seams_alone and free.any() and free.all()):
        return False
    linked = links.rows[:, :, :d].sum(axis=1).any()
    mass = np.trace(matrix.mass_matrix[:, :d, :d].sum(axis=0)) / d
    return bool(not linked and mass < share * _resistance(matrix))


def adrift(found: str) -> StepError:
    """Error for bodies whose velocity, together with the fluid's, nothing tells."""
    return StepError(
        "boundary",
        f"{found}, bodies of next to no mass, and a fluid without inertia that no wall holds",
        "a flux on one surface of each periodic pair, which says how fast all goes",
        "Give each pair a flux, fix a body, or use a fluid with inertia.",
    )


def _resistance(matrix: CoupledMatrix) -> float:
    """Resistance μ Lᵈ⁻² [force·time/length]."""
    d = matrix.points.shape[1]
    return float(matrix.viscosity * np.ptp(matrix.points, axis=0).max() ** (d - 2))
