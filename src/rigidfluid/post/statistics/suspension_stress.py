"""Stress that bodies add to that of the fluid, and the viscosity of a suspension in shear."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.model.system import System
from rigidfluid.post.statistics.blocks import Mean, mean
from rigidfluid.post.statistics.samples import Samples

_OPPOSITE = -1.0 + 1e-9
"""Product of the unit normals of two walls below which they face each other [1]."""


class Shear(NamedTuple):
    """Shear between two walls: its ``rate`` [1/time], the direction ``along`` (d,) in which one slides and the normal
    ``across`` (d,) towards it [1]."""

    rate: float
    along: FloatArray
    across: FloatArray


class SuspensionStress(NamedTuple):
    """Stress of the bodies by the fluid, ΣS/V, and with that of contacts, both (d, d) [force/length^(d-1)]; and between
    walls that shear, the ``shear_rate`` [1/time] and the ``relative_viscosity`` [1], None without these."""

    by_fluid: Mean
    total: Mean
    shear_rate: float | None
    relative_viscosity: Mean | None

    def to_dict(self) -> dict[str, Any]:
        """Names, numbers and lists."""
        viscosity = self.relative_viscosity
        return {
            "fluid": self.by_fluid.to_list(),
            "total": self.total.to_list(),
            "shear_rate": self.shear_rate,
            "relative_viscosity": None if viscosity is None else viscosity.to_list(),
        }


def suspension_stress(
    samples: Samples, system: System, table: Mapping[str, NDArray[Any]], contacts: FloatArray
) -> SuspensionStress | None:
    """Mean stress of the bodies that move; None where the ``table`` of stresslets has none in these states.

    Σ = ΣS/V + Σᶜ with the stresslets S of the bodies and the stress of contacts Σᶜ (s, d, d), ``contacts``; between
    walls that slide past each other at a rate γ the viscosity is 1 + t·Σ·n/(μγ) times the fluid's. It is that of bodies
    on which no other forces act, in a fluid without inertia.

    Notes
    -----
    Batchelor, J. Fluid Mech. 41 (1970) 545, doi:10.1017/S0022112070000745.
    """
    by_fluid = _sums(samples, table) / samples.volume
    known = np.isfinite(by_fluid).all(axis=(1, 2))
    if not known.any():
        return None
    total = by_fluid[known] + 0.5 * (contacts + contacts.swapaxes(1, 2))[known]
    shear = shear_of_walls(system)
    if shear is None or system.fluid is None:
        return SuspensionStress(mean(by_fluid[known]), mean(total), None, None)
    viscosity = system.fluid.material.dynamic_viscosity * shear.rate
    relative = 1.0 + np.einsum("i,sij,j->s", shear.along, total, shear.across) / viscosity
    return SuspensionStress(mean(by_fluid[known]), mean(total), shear.rate, mean(relative))


def shear_of_walls(system: System) -> Shear | None:
    """Shear between two opposite flat walls, one of which at least slides; None if there are none, or several pairs."""
    middle = 0.5 * (system.domain.extent[0] + system.domain.extent[1])
    flat = [(wall, wall.shape.plane.unit_normal) for wall in system.walls if wall.shape.plane is not None]
    opposite = [
        (one, two, normal) for (one, normal), (two, other) in combinations(flat, 2) if normal @ other < _OPPOSITE
    ]
    found = [_shear(one, two, normal, middle) for one, two, normal in opposite]
    moving = [shear for shear in found if shear.rate > 0.0]
    return moving[0] if len(moving) == 1 else None


def _shear(one: Wall, two: Wall, normal: FloatArray, middle: FloatArray) -> Shear:
    """Shear between two walls, the first with this unit ``normal`` (d,) into the fluid, at points next to one (d,)."""
    places = [wall.shape.closest_point(middle[None]) for wall in (one, two)]
    slides = [_sliding(wall, place) for wall, place in zip((one, two), places, strict=True)]
    change, distance = slides[1] - slides[0], float((places[1] - places[0])[0] @ normal)
    size = float(np.linalg.norm(change))
    return Shear(size / distance, change / max(size, np.finfo(float).tiny), normal)


def _sliding(wall: Wall, place: FloatArray) -> FloatArray:
    """Velocity of a wall (d,) at a place (1, d) on it [length/time]."""
    return np.zeros(place.shape[1]) if wall.velocity is None else wall.velocity(place)[0]


def _sums(samples: Samples, table: Mapping[str, NDArray[Any]]) -> FloatArray:
    """Sum of the stresslets of the bodies that move in each state (s, d, d) [force·length]; not a number where they are
    not known."""
    d = samples.dimension
    rows, columns = np.triu_indices(d)
    states = np.searchsorted(samples.step, table["step"])
    known = (states < len(samples.step)) & np.isin(table["body"], samples.name)
    known[known] = samples.step[states[known]] == table["step"][known]
    sums, count = np.zeros((len(samples.step), d, d)), np.bincount(states[known], minlength=len(samples.step))
    for row, column in zip(rows, columns, strict=True):
        np.add.at(sums[:, row, column], states[known], table[f"s{'xyz'[row]}{'xyz'[column]}"][known])
    sums[:, columns, rows] = sums[:, rows, columns]
    sums[count != samples.count] = np.nan
    return sums
