"""Two equal disks of a run: their ways, the gap between them, and when they kiss, tumble and part."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from page_tools import Run

Way = dict[str, np.ndarray]
"""Columns of bodies.csv of one body."""


@dataclass(frozen=True)
class Pair:
    """The disks named ``trailing`` and ``leading``, of one radius, and the range of the law between them."""

    run: Run
    trailing: str
    leading: str

    @cached_property
    def radius(self) -> float:
        """Of both [length]."""
        return float(self.scene["body"][0]["radius"])

    @cached_property
    def range(self) -> float:
        """Of the contact law [length]."""
        return float(self.scene["contact"]["range"])

    @property
    def scene(self) -> dict:
        """The tables of the run's scene."""
        return self.run.summary["scene"]

    @cached_property
    def ways(self) -> tuple[Way, Way]:
        """Of the trailing and the leading disk."""
        bodies = self.run.history.bodies
        mine = (bodies["body"] == name for name in (self.trailing, self.leading))
        first, second = ({key: column[rows] for key, column in bodies.items()} for rows in mine)
        return first, second

    @cached_property
    def time(self) -> np.ndarray:
        """Of each state [time]."""
        return self.ways[0]["time"]

    @cached_property
    def gap(self) -> np.ndarray:
        """Between the disks, at each state [length]."""
        return np.hypot(*self._across) - 2.0 * self.radius

    @cached_property
    def tilt(self) -> np.ndarray:
        """Angle of the line of centres from the vertical, at each state [degree]; 90 when they are side by side."""
        x, y = self._across
        return np.degrees(np.arctan2(np.abs(x), y))

    @cached_property
    def kiss(self) -> float:
        """When the disks come within the range of the law; never is not a number."""
        return self._first(self.gap < self.range)

    @cached_property
    def side_by_side(self) -> float:
        """When they are first at one height."""
        return self._first(self.tilt > 90.0)

    @cached_property
    def parts(self) -> float:
        """When they leave the range of the law for the last time before the end."""
        near = np.flatnonzero(self.gap < self.range)
        last = near[-1] + 1 if len(near) else len(self.time)
        return float(self.time[last]) if last < len(self.time) else np.nan

    @cached_property
    def in_contact(self) -> float:
        """How long they are within range in all [time]."""
        return float(np.diff(self.time)[self.gap[1:] < self.range].sum())

    def at(self, moment: float, column: str) -> tuple[float, float]:
        """A column of both disks at a time."""
        first, second = (float(np.interp(moment, way["time"], way[column])) for way in self.ways)
        return first, second

    def off(self, other: Pair, until: float) -> float:
        """The largest distance between a disk here and there, up to a time [length]."""
        times = self.time[self.time <= until]
        return max(
            float(
                np.hypot(
                    *(np.interp(times, one["time"], one[k]) - np.interp(times, two["time"], two[k]) for k in "xy")
                ).max()
            )
            for one, two in zip(self.ways, other.ways, strict=True)
        )

    @property
    def _across(self) -> tuple[np.ndarray, np.ndarray]:
        first, second = self.ways
        return first["x"] - second["x"], first["y"] - second["y"]

    def _first(self, holds: np.ndarray) -> float:
        return float(self.time[np.argmax(holds)]) if holds.any() else np.nan


def energy_shares(run: Run) -> tuple[float, float]:
    """Energy created and lost, over that put in."""
    energy = run.summary["energy"]
    return energy["created"], energy["lost"]
