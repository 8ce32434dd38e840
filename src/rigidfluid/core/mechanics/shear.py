"""Shear of a fluid between walls that slide past each other."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.generalised_newtonian import GeneralisedNewtonian
from rigidfluid.core.model.system import System

_OPPOSITE = -1.0 + 1e-9
"""Product of the unit normals of two walls below which they face each other [1]."""


class Shear(NamedTuple):
    """Shear between two walls: its ``rate`` γ [1/time], the ``stress`` μγ of the fluid alone, None where its viscosity
    varies [force/length^(d-1)], the direction ``along`` (d,) in which one ``wall`` slides, by its name, and the normal
    ``across`` (d,) towards it [1]."""

    rate: float
    stress: float | None
    along: FloatArray
    across: FloatArray
    wall: str

    def part(self, one: FloatArray, other: FloatArray, stress: FloatArray) -> FloatArray:
        """Component (…) of stresses Σ (…, d, d), ``one``·Σ·``other`` of two directions (d,)."""
        return np.asarray(np.einsum("i,...ij,j->...", one, stress, other))

    def velocity(self, position: FloatArray) -> FloatArray:
        """Velocity γ (x·n) t (…, d) of the shear at positions x (…, d), but for one that is the same everywhere
        [length/time]."""
        return self.rate * (position @ self.across)[..., None] * self.along

    def normal_differences(self, stress: FloatArray) -> FloatArray:
        """Normal stress differences (…, d - 1) of stresses Σ (…, d, d), N₁ = t·Σ·t - n·Σ·n and in 3D N₂ = n·Σ·n -
        w·Σ·w, w along the vorticity [force/length^(d-1)]."""
        along, across = (self.part(way, way, stress) for way in (self.along, self.across))
        vorticity = np.trace(stress, axis1=-2, axis2=-1) - along - across
        return np.stack([along - across, across - vorticity], axis=-1)[..., : stress.shape[-1] - 1]

    def viscosity_at_wall(self, traction: FloatArray) -> FloatArray | None:
        """Viscosity -t·τ/(μγ) (…) by tractions τ (…, d) on the wall that slides along, over the fluid's; None where it
        varies [1]."""
        return None if self.stress is None else -(traction @ self.along) / self.stress

    def added_viscosity(self, stress: FloatArray) -> FloatArray | None:
        """Viscosity t·Σ·n/(μγ) (…) that stresses Σ (…, d, d) add to the fluid's, over it; None where it varies [1]."""
        return None if self.stress is None else self.part(self.along, self.across, stress) / self.stress


def shear_of_walls(system: System) -> Shear | None:
    """Shear of a fluid between two opposite flat walls, one of which at least slides; None if there are none, or
    several pairs."""
    if system.fluid is None:
        return None
    middle = 0.5 * (system.domain.extent[0] + system.domain.extent[1])
    flat = [(wall, wall.shape.plane.unit_normal) for wall in system.walls if wall.shape.plane is not None]
    opposite = [
        (one, two, normal) for (one, normal), (two, other) in combinations(flat, 2) if normal @ other < _OPPOSITE
    ]
    material = system.fluid.material
    viscosity = None if isinstance(material, GeneralisedNewtonian) else material.dynamic_viscosity
    found = [_shear(one, two, normal, middle, viscosity) for one, two, normal in opposite]
    moving = [shear for shear in found if shear.rate > 0.0]
    return moving[0] if len(moving) == 1 else None


def _shear(one: Wall, two: Wall, normal: FloatArray, middle: FloatArray, viscosity: float | None) -> Shear:
    """Shear of a fluid of this ``viscosity`` between two walls, the first with this unit ``normal`` (d,) into it, at
    points next to one (d,)."""
    places = [wall.shape.closest_point(middle[None]) for wall in (one, two)]
    slides = [_sliding(wall, place) for wall, place in zip((one, two), places, strict=True)]
    change, distance = slides[1] - slides[0], float((places[1] - places[0])[0] @ normal)
    size = float(np.linalg.norm(change))
    rate = size / distance
    return Shear(rate, viscosity and viscosity * rate, change / max(size, np.finfo(float).tiny), normal, two.name)


def _sliding(wall: Wall, place: FloatArray) -> FloatArray:
    """Velocity of a wall (d,) at a place (1, d) on it [length/time]."""
    return np.zeros(place.shape[1]) if wall.velocity is None else wall.velocity(place)[0]
