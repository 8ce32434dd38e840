"""A conservative law as LAMMPS reads it: energy and force over the distance of the centres, in tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigidfluid.api import Contacts, FloatArray, ForceLaw

POINTS = 10_001
"""In each table, joined by cubic splines: the force is then right to 1e-9 of its largest value."""

CLOSEST = 0.01
"""Least gap in the table of a law that is unbounded at contact, over the range."""


@dataclass(frozen=True)
class Pair:
    """Two surfaces: the numbers of ``bodies`` a and b, and their ``radii``, infinite of a flat wall [length]."""

    bodies: tuple[int, int]
    radii: tuple[float, float]
    at_wall: bool = False

    @property
    def touching(self) -> float:
        """Distance of the centres, from a wall that of the centre and the wall, where the surfaces touch [length]."""
        return sum(radius for radius in self.radii if np.isfinite(radius))


def write_table(path: Path, law: ForceLaw, pair: Pair) -> float:
    """Write a conservative law for ``pair_style table`` or ``fix wall/table`` (``LAW``); return its cutoff [length]."""
    first = CLOSEST * law.range if law.overlap == "unbounded" else 0.0
    low, high = pair.touching + first, pair.touching + law.range
    distance = _squares(low, high) if np.isfinite(pair.radii[1]) else np.linspace(low, high, POINTS)
    distance[[0, -1]] = low, high
    contacts = _contacts(pair, np.clip(distance - pair.touching, first, law.range))
    force, energy = law.force(contacts)[:, 0], law.energy(contacts)
    slope_low, slope_high = -law.stiffness(contacts)[[0, -1]]
    grid = f"RSQ {low:.17g} {high:.17g} FPRIME" if np.isfinite(pair.radii[1]) else "FP"
    head = f"LAW\nN {POINTS} {grid} {slope_low:.17g} {slope_high:.17g}\n"
    rows = np.column_stack([np.arange(1, POINTS + 1), distance, energy, force])
    np.savetxt(path, rows, ["%d", "%.17g", "%.17g", "%.17g"], header=head, comments="")
    return high


def _squares(low: float, high: float) -> FloatArray:
    """Distances whose squares are evenly spaced, as LAMMPS looks pairs up."""
    return np.sqrt(np.linspace(low**2, high**2, POINTS))


def _contacts(pair: Pair, gap: FloatArray) -> Contacts:
    count = len(gap)
    normal = np.zeros((count, 3))
    normal[:, 0] = 1.0
    return Contacts(
        body_a=np.full(count, pair.bodies[0]),
        body_b=np.full(count, pair.bodies[1]),
        point_a=gap[:, None] * normal,
        point_b=np.zeros((count, 3)),
        normal=normal,
        gap=gap,
        radius_a=np.full(count, pair.radii[0]),
        radius_b=np.full(count, pair.radii[1]),
        at_wall=np.full(count, pair.at_wall),
    )
