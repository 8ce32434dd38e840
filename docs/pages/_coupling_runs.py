"""Runs of disks in three ways: as one system, explicit, and iterated; each against one system with short steps."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pages._staggered import RADIUS, SIDE, VOLUME, Disk, NotSettledError, Staggered, disk_scene
from rigidfluid.api import Simulation
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.output.history import History
from rigidfluid.errors import StepError

ONE, EXPLICIT, ITERATED, FINE = "one system", "explicit", "iterated", "fine"
WAYS = (ONE, EXPLICIT, ITERATED)
MOST = {EXPLICIT: 1, ITERATED: 50}
"""Flow solves that a step may take."""
SHORTEST = 0.25e-3
"""Step of the fine runs, as one system, that all others are held against [s]."""
FACTOR = 10.0
"""A speed so many times the greatest of the fine run is no result any more."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """Disks that move until ``end`` [s] in a box of this ``width``, by steps [s]; ``shown`` keeps their paths."""

    disks: Sequence[Disk]
    end: float
    steps: Sequence[float]
    width: float = SIDE
    shown: bool = False


@dataclass(frozen=True)
class Done:
    """A run: its ``history``, whether it came to its end, energy that came from nowhere over the work of gravity, flow
    solves and CPU seconds of all steps."""

    history: History
    ended: bool
    created: float
    solves: int
    seconds: float

    def column(self, name: str) -> FloatArray:
        """A quantity of the disks after each step (s, n)."""
        return np.asarray(self.history.bodies[name].reshape(len(self.times), -1))

    @property
    def times(self) -> FloatArray:
        """Times of the start and all steps (s,)."""
        return np.unique(self.history.bodies["time"])

    @property
    def fastest(self) -> float:
        """Greatest speed."""
        return float(np.hypot(self.column("vx"), self.column("vy")).max())

    def off(self, fine: Done, name: str) -> float:
        """Root of the mean square of a quantity's difference from a fine run, all disks and times alike."""
        found, known = self.column(name), fine.column(name)
        there = [np.interp(self.times, fine.times, known[:, i]) for i in range(found.shape[1])]
        return float(np.sqrt(np.mean((found - np.transpose(there)) ** 2)))


def rows_of(name: str, case: Case) -> Iterator[Row]:
    """Of one case, a row for each way and step, the fine run first."""
    fine = _as_one(case, SHORTEST)
    yield _row(name, FINE, SHORTEST, fine, fine) | _path(case, fine)
    for step in case.steps:
        for way in WAYS:
            run = _as_one(case, step) if way == ONE else _in_turn(case, step, MOST[way], FACTOR * fine.fastest)
            yield _row(name, way, step, run, fine) | _path(case, run)


def _as_one(case: Case, step: float) -> Done:
    run = Simulation(disk_scene(case.disks, free=True, step=step, end=case.end, width=case.width))
    start = time.process_time()
    run.go()
    seconds, ledger = time.process_time() - start, run.history.energy
    solves = len(ledger["time"]) - 1 + run.counts.rejected
    return Done(run.history, True, float(-ledger["residual"][-1] / ledger["gravity"][-1]), solves, seconds)


def _in_turn(case: Case, step: float, most: int, limit: float) -> Done:
    turns = Staggered(case.disks, step=step, end=case.end, width=case.width, most=most)
    start, ended = time.process_time(), True
    try:
        while ended and not turns.run.ended:
            turns.step()
            ended = turns.fastest < limit
    except (NotSettledError, StepError):
        ended = False
    return Done(turns.run.history, ended, turns.created, turns.solves, time.process_time() - start)


def _row(name: str, way: str, step: float, run: Done, fine: Done) -> Row:
    """What JSON can hold; errors and energies of those runs alone that came to their end. ``added`` is the mass that
    the first disk felt in the first step, over that of the fluid it displaces."""
    steps = len(run.times) - 1
    row = {"case": name, "way": way, "step": step, "ended": run.ended, "until": float(run.times[-1])}
    row |= {"fastest": run.fastest / fine.fastest, "solves": run.solves / steps, "ms": 1e3 * run.seconds / steps}
    row |= {"remeshes": int(run.history.steps["remeshes"][-1]), "gap": float(run.column("gap").min()) / RADIUS}
    if way == EXPLICIT:
        row["added"] = float(-run.column("fy")[1, 0] * step / (VOLUME * run.column("vy")[1, 0]))
    if run.ended:
        row |= {"speed_off": run.off(fine, "vy") / fine.fastest, "height_off": run.off(fine, "y") / RADIUS}
        row["created"] = run.created
    return {key: float(f"{value:.5g}") if isinstance(value, float) else value for key, value in row.items()}


def _path(case: Case, run: Done) -> Mapping[str, list[float]]:
    """Times, heights and velocities of the first disk, and when meshes were made, of a case that is shown."""
    if not case.shown:
        return {}
    made = run.history.steps["time"][1:][np.diff(run.history.steps["remeshes"]) > 0]
    path = {"times": run.times, "heights": run.column("y")[:, 0], "velocities": run.column("vy")[:, 0], "made": made}
    return {key: [float(f"{value:.5g}") for value in values] for key, values in path.items()}
