"""How far two runs of a scene are apart, at the times of the first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import BoolArray, FloatArray
from rigidfluid.core.mechanics.rigid import angle_between
from rigidfluid.post.reports.results import Results

ORIENTATION, ENERGY = "orientation", "energy"
UNITS = {
    "position": "length",
    "velocity": "length/time",
    ORIENTATION: "rad",
    "spin": "rad/time",
    "hydrodynamic_force": "force",
    ENERGY: "energy",
}
"""Compared quantities and their units; energy is the kinetic of fluid and bodies plus that stored in contacts."""

Histories = dict[str, FloatArray]
"""Quantity → history (s, n, c): c components of n bodies at s times; energy has n = 1."""


@dataclass(frozen=True)
class Difference:
    """Difference of one quantity: ``values`` (s, n) at s times for n bodies, or (s, 1) if it ``is_global``.

    The ``range`` is how much the quantity changes in the reference's run: the diagonal of the box that holds a body's
    values, of orientations the largest angle from that at the start; the largest of all bodies.
    """

    values: FloatArray
    range: float
    is_global: bool

    @property
    def largest(self) -> float:
        """Largest difference over time and bodies."""
        return float(self.values.max())

    @property
    def final(self) -> float:
        """Largest difference over the bodies, at the last time."""
        return float(self.values[-1].max())

    @property
    def relative(self) -> float | None:
        """The largest difference over the range; None where the range is 0."""
        return self.largest / self.range if self.range > 0.0 else None

    @property
    def largest_at(self) -> tuple[int, int]:
        """Numbers of the time and of the body of the largest difference."""
        time, body = np.unravel_index(int(np.argmax(self.values)), self.values.shape)
        return int(time), int(body)


@dataclass(frozen=True)
class Pair:
    """One backend compared with the reference: differences by quantity at common ``time`` (s,) [time].

    ``interpolated`` (s,) says where the other run has no step, so that its values lie on a line between two steps.
    """

    reference: str
    other: str
    time: FloatArray
    interpolated: BoolArray
    differences: dict[str, Difference]


def label(name: str) -> str:
    """A quantity's name as readers see it."""
    return name.replace("_", " ")


def pair(reference: tuple[str, Results], other: tuple[str, Results]) -> Pair:
    """Compare two runs, each a backend's name and results, at the reference's steps that lie within both."""
    (first, ours), (second, theirs) = reference, other
    common = (ours.time >= theirs.time[0]) & (ours.time <= theirs.time[-1])
    time = ours.time[common]
    mine, others = histories(ours), interpolated(histories(theirs), theirs.time, time)
    differences = {
        name: Difference(_apart(name)(values[common], others[name]), _range(name, values), name == ENERGY)
        for name, values in mine.items()
    }
    return Pair(first, second, time, ~np.isin(time, theirs.time), differences)


def histories(results: Results) -> Histories:
    """Histories of the quantities that a comparison of runs takes."""
    energy = results.energy["kinetic"] + results.energy["contact"]
    return {
        "position": results.quantity("position"),
        "velocity": results.quantity("velocity"),
        ORIENTATION: results.quantity("orientation"),
        "spin": results.quantity("angular_velocity"),
        "hydrodynamic_force": results.quantity("force"),
        ENERGY: energy[:, None, None],
    }


def interpolated(values: Mapping[str, FloatArray], time: FloatArray, at: FloatArray) -> Histories:
    """Histories, linear between the steps ``time`` (s,), ``at`` times (m,) within; quaternions are normalised."""
    before = np.searchsorted(time, at, side="right") - 1
    after = np.minimum(before + 1, len(time) - 1)
    gap = time[after] - time[before]
    weight = np.divide(at - time[before], gap, out=np.zeros(len(at)), where=gap > 0.0)[:, None, None]
    return {name: _between(name, history[before], history[after], weight) for name, history in values.items()}


def _between(name: str, start: FloatArray, end: FloatArray, weight: FloatArray) -> FloatArray:
    if name != ORIENTATION or start.shape[2] == 1:
        return np.asarray(start + weight * (end - start))
    end = np.where(np.sum(start * end, axis=2, keepdims=True) < 0.0, -end, end)  # q and -q are one orientation
    mixed = start + weight * (end - start)
    return np.where(weight > 0.0, mixed / np.linalg.norm(mixed, axis=2, keepdims=True), start)


def _apart(name: str) -> Callable[[FloatArray, FloatArray], FloatArray]:
    return _angle if name == ORIENTATION else _distance


def _distance(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(other - one, axis=2))


def _angle(one: FloatArray, other: FloatArray) -> FloatArray:
    components = one.shape[2]
    return angle_between(one.reshape(-1, components), other.reshape(-1, components)).reshape(one.shape[:2])


def _range(name: str, values: FloatArray) -> float:
    if name == ORIENTATION:
        return float(_angle(np.broadcast_to(values[:1], values.shape), values).max())
    return float(np.linalg.norm(np.ptp(values, axis=0), axis=1).max())
