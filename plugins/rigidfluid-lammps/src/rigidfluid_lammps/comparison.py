"""Differences between two programs' samples, until chaos parts them, and of their means."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigidfluid.api import FloatArray, System
from rigidfluid_lammps.kinds import radii
from rigidfluid_lammps.samples import Samples

PARTED = 0.01
"""Positions that differ by more than this, over the smallest radius, are two different histories."""


@dataclass(frozen=True)
class Means:
    """Means over all samples: ``energy`` [energy], |``momentum``|, ``pressure`` on the walls [force/length^(d-1)]."""

    energy: float
    momentum: float
    pressure: float


@dataclass(frozen=True)
class Row:
    """Both programs at one ``step`` [time]; differences are the largest, at the times before they part.

    ``position`` [length], ``velocity`` [length/time], ``spin`` [rad/time]; ``energy``, kinetic and stored, and
    ``momentum``, over their largest values. ``from_finest`` [length]: our positions from LAMMPS' with the shortest
    step. ``parted`` [time]: when positions differ by more than a hundredth of the smallest radius; None if never.
    """

    step: float
    position: float
    velocity: float
    spin: float
    energy: float
    momentum: float
    from_finest: float
    parted: float | None
    ours: Means
    theirs: Means


@dataclass(frozen=True)
class Comparison:
    """A row for each step, the longest first, and the samples behind the row with the shortest."""

    rows: tuple[Row, ...]
    ours: Samples
    theirs: Samples


def compared(system: System, steps: Sequence[float], pairs: Sequence[tuple[Samples, Samples]]) -> Comparison:
    """Compare pairs of samples, ours and LAMMPS' at the same times, one pair for each step, longest first [time]."""
    finest = pairs[-1][1]
    rows = [_row(system, step, ours, theirs, finest) for step, (ours, theirs) in zip(steps, pairs, strict=True)]
    return Comparison(tuple(rows), *pairs[-1])


def _row(system: System, step: float, ours: Samples, theirs: Samples, finest: Samples) -> Row:
    mass, inertia = system.mass * ~system.prescribed, system.inertia[:, 0, 0] * ~system.prescribed
    together, parted = _together(system, ours, theirs)
    ours_energy, theirs_energy = ours.energy(mass, inertia), theirs.energy(mass, inertia)
    ours_momentum, theirs_momentum = ours.momentum(mass), theirs.momentum(mass)
    pace = np.sum(mass * np.linalg.norm(ours.velocity, axis=2), axis=1)
    return Row(
        step=step,
        position=_apart(ours.position, theirs.position, together),
        velocity=_apart(ours.velocity, theirs.velocity, together),
        spin=_apart(ours.spin, theirs.spin, together),
        energy=_apart(ours_energy, theirs_energy, together) / _scale(ours_energy),
        momentum=_apart(ours_momentum, theirs_momentum, together) / _scale(pace),
        from_finest=_apart(ours.position, finest.position, _together(system, ours, finest)[0]),
        parted=parted,
        ours=_means(system, ours, ours_energy, ours_momentum),
        theirs=_means(system, theirs, theirs_energy, theirs_momentum),
    )


def _together(system: System, ours: Samples, theirs: Samples) -> tuple[int, float | None]:
    """How many samples come before the histories part, and when they do."""
    apart = np.linalg.norm(ours.position - theirs.position, axis=2).max(axis=1)
    far = np.flatnonzero(apart > PARTED * radii(system).min())
    return (len(apart), None) if len(far) == 0 else (int(far[0]), float(ours.time[far[0]]))


def _apart(ours: FloatArray, theirs: FloatArray, together: int) -> float:
    return float(np.abs(ours[:together] - theirs[:together]).max())


def _scale(values: FloatArray) -> float:
    """The largest of them; one where all are zero, as their differences then are."""
    return float(np.abs(values).max()) or 1.0


def _means(system: System, samples: Samples, energy: FloatArray, momentum: FloatArray) -> Means:
    repelling = {wall.name for wall in system.walls}
    area = sum(piece.area for piece in system.domain.pieces if piece.name in repelling)
    force = float(samples.wall_force.sum(axis=1).mean()) if area else 0.0
    total = float(np.linalg.norm(momentum, axis=1).mean())
    return Means(float(energy.mean()), total, force / area if area else 0.0)
