"""Bodies of a run at even times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.mechanics.shear import Shear, shear_of_walls
from rigidfluid.core.model.system import System
from rigidfluid.errors import OutputError
from rigidfluid.post.reports.results import Results

SAMPLES = 200
"""Most states that are looked at."""

LEAST = 2
"""Fewest bodies and states that have statistics."""


@dataclass(frozen=True)
class Samples:
    """Bodies that move, n of them, in s states.

    ``step`` (s,) numbers of the states; ``time`` (s,) [time]; ``position`` and ``velocity`` (s, n, d) [length,
    length/time]; ``angular_velocity`` (s, n, k) [rad/time]; ``gap`` (s, n), of each body to its nearest surface
    [length]; ``radius`` (n,) of balls of the same volume [length]; ``name`` of each body; ``lower`` and ``upper`` (d,),
    corners of the domain [length]; ``volume`` of the domain with bodies [length^d]; ``period`` (d,) along each axis,
    infinite between walls [length]; ``shear`` of the fluid between walls that slide.
    """

    step: FloatArray
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    angular_velocity: FloatArray
    gap: FloatArray
    radius: FloatArray
    name: tuple[str, ...]
    lower: FloatArray
    upper: FloatArray
    volume: float
    period: FloatArray
    shear: Shear | None

    @property
    def periodic(self) -> BoolArray:
        """Tell whether the domain is periodic along each axis (d,)."""
        return np.isfinite(self.period)

    def periods(self, differences: FloatArray) -> FloatArray:
        """Whole periods nearest to ``differences`` (…, d), (…, d) [length]."""
        length = np.where(self.periodic, self.period, 1.0)
        return np.asarray(np.where(self.periodic, length * np.rint(differences / length), 0.0))

    @property
    def count(self) -> int:
        """Number of bodies n."""
        return len(self.radius)

    @property
    def dimension(self) -> int:
        """Number of space dimensions d."""
        return len(self.lower)

    @property
    def interval(self) -> float:
        """Time between states [time]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    @property
    def own_path(self) -> FloatArray:
        """Positions (s, n, d) without what a shear has moved bodies since the first state, and less their mean
        [length]."""
        path = self.position
        if self.shear is not None:
            sheared = cumulative_trapezoid(self.shear.velocity(path), self.time, axis=0, initial=0)
            path = path - sheared
        return np.asarray(path - path.mean(axis=1, keepdims=True))

    @property
    def body_volume(self) -> FloatArray:
        """Volume of each body (n,) [length^d]."""
        return np.asarray(np.pi * self.radius**2 if self.dimension == 2 else 4.0 / 3.0 * np.pi * self.radius**3)

    @property
    def fraction(self) -> float:
        """Volume of the bodies over that of the domain [1]."""
        return float(self.body_volume.sum() / self.volume)


def samples_of(results: Results, since: float | None, until: float | None, most: int = SAMPLES) -> Samples:
    """Samples of a run from one time to another, at ``most`` so many; from a third of it on if not given, when most
    starts are forgotten.

    Raises OutputError if there are too few states or bodies, or a body enters or leaves meanwhile.
    """
    start, end = float(results.time[0]), float(results.time[-1])
    since, until = start + (end - start) / 3.0 if since is None else since, end if until is None else until
    if not start <= since < until:
        allowed, remedy = f"two times from {start:g} to {end:g}, in order", "Correct --since or --until."
        raise OutputError("statistics, times", f"{since:g} to {until:g}", allowed, remedy)
    inside = int(np.sum((results.time >= since) & (results.time <= until)))
    wanted = np.linspace(since, min(until, end), max(LEAST, min(SAMPLES, most, inside)))
    rows = np.unique([results.state_at(time) for time in wanted])
    present = results.present[rows[0] : rows[-1] + 1]
    moving = np.flatnonzero(~results.system.prescribed & present.any(axis=0))
    changing = [results.names[body] for body in moving if not present[:, body].all()]
    if changing:
        remedy = "Choose times between which no body does, by --since and --until."
        found = f"from {since:g} to {until:g} bodies that enter or leave: {', '.join(changing[:20])}"
        raise OutputError("statistics", found, "the same bodies at all times", remedy)
    if len(rows) < LEAST or len(moving) < LEAST:
        found = f"{len(rows)} states and {len(moving)} bodies that move"
        remedy = "Choose a longer time, or a run of more bodies."
        raise OutputError("statistics", found, f"at least {LEAST} of each", remedy)
    return samples_at(results, rows, moving)


def samples_at(results: Results, rows: IntArray, bodies: IntArray) -> Samples:
    """Samples of some ``bodies`` (n,) in the states of these ``rows`` (s,), by number; raises OutputError where periods
    are along no axis."""
    system = results.system
    lower, upper = system.domain.extent
    position, velocity, turning = (
        results.quantity(name)[rows][:, bodies] for name in ("position", "velocity", "angular_velocity")
    )
    return Samples(
        step=results.bodies["step"][rows, 0],
        time=results.time[rows],
        position=position,
        velocity=velocity,
        angular_velocity=turning,
        gap=results.bodies["gap"][rows][:, bodies],
        radius=np.array([equal_volume_radius(system.bodies[body]) for body in bodies]),
        name=tuple(results.names[body] for body in bodies),
        lower=np.asarray(lower),
        upper=np.asarray(upper),
        volume=float(system.domain.volume),
        period=_periods(system),
        shear=shear_of_walls(system),
    )


def _periods(system: System) -> FloatArray:
    """Periods along the axes (d,), infinite without one [length]; raises OutputError for oblique ones."""
    found, vectors = np.full(system.dimension, np.inf), system.domain.lattice
    axis = np.argmax(np.abs(vectors), axis=1)
    found[axis] = np.abs(vectors)[np.arange(len(vectors)), axis]
    if np.count_nonzero(np.abs(vectors) > 1e-9 * np.abs(vectors).max(initial=0.0)) > len(vectors):
        remedy = "Place the domain along the axes."
        raise OutputError("statistics", "periodic surfaces across no axis", "such across an axis", remedy)
    return found
