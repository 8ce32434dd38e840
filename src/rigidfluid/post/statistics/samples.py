"""Bodies of a run at even times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
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
    """Bodies that move, in s states: n of them, all that were there in any of these.

    ``step`` (s,) numbers of the states; ``time`` (s,) [time]; ``position`` and ``velocity`` (s, n, d) [length,
    length/time]; ``angular_velocity`` (s, n, k) [rad/time]; ``gap`` (s, n), of each body to its nearest surface
    [length]; where a body is not there, not a number, and an infinite gap; ``radius`` (n,) of balls of the same volume
    [length]; ``name`` of each body; ``lower`` and ``upper`` (d,), corners of the domain [length]; ``volume`` of the
    domain with bodies [length^d]; ``period`` (d,) along each axis, infinite between walls [length]; ``shear`` of the
    fluid between walls that slide.
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
    def present(self) -> BoolArray:
        """Tell which bodies are there in each state (s, n)."""
        return np.isfinite(self.position[..., 0])

    @property
    def count(self) -> IntArray:
        """Number of bodies in each state (s,)."""
        return np.asarray(np.count_nonzero(self.present, axis=1))

    def map_states(self, figure: Callable[..., ArrayLike], *values: FloatArray, least: int = 1) -> FloatArray:
        """A ``figure`` of the bodies in each state that has at ``least`` so many (t, …), by their rows (b, …) of the
        ``values`` (s, n, …)."""
        states = zip(self.present, *values, strict=True)
        return np.array(
            [figure(*(one[there] for one in rows)) for there, *rows in states if np.count_nonzero(there) >= least]
        )

    def zero_without(self, values: FloatArray) -> FloatArray:
        """The ``values`` (s, n, …), and zero where a body is not there."""
        there = self.present.reshape(*self.present.shape, *[1] * (values.ndim - 2))
        return np.where(there, values, 0.0)

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
        """Positions (s, n, d) without what a shear has moved each body, to a constant of its own [length]."""
        if self.shear is None:
            return self.position
        flow = self.zero_without(self.shear.velocity(self.position))
        return np.asarray(self.position - cumulative_trapezoid(flow, self.time, axis=0, initial=0))

    @property
    def body_volume(self) -> FloatArray:
        """Volume of each body (n,) [length^d]."""
        return np.asarray(np.pi * self.radius**2 if self.dimension == 2 else 4.0 / 3.0 * np.pi * self.radius**3)


def samples_of(results: Results, since: float | None, until: float | None, most: int = SAMPLES) -> Samples:
    """Samples of a run from one time to another, at ``most`` so many; from a third of it on if not given, when most
    starts are forgotten.

    Raises OutputError if there are too few states with too few bodies.
    """
    start, end = float(results.time[0]), float(results.time[-1])
    since, until = start + (end - start) / 3.0 if since is None else since, end if until is None else until
    if not start <= since < until:
        allowed, remedy = f"two times from {start:g} to {end:g}, in order", "Correct --since or --until."
        raise OutputError("statistics, times", f"{since:g} to {until:g}", allowed, remedy)
    inside = int(np.sum((results.time >= since) & (results.time <= until)))
    wanted = np.linspace(since, min(until, end), max(LEAST, min(SAMPLES, most, inside)))
    rows = np.unique([results.state_at(time) for time in wanted])
    moving = results.present[rows] & ~results.system.prescribed
    count = np.count_nonzero(moving, axis=1)
    if np.count_nonzero(count >= LEAST) < LEAST:
        found = f"{len(rows)} states, with at most {count.max()} bodies that move"
        remedy = "Choose a longer time, or a run of more bodies."
        raise OutputError("statistics", found, f"at least {LEAST} states with at least {LEAST} bodies", remedy)
    return samples_at(results, rows, np.flatnonzero(moving.any(axis=0)))


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
