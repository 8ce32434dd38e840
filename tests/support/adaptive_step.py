"""Errors of runs with fixed steps and with tolerances, from the same scene with a very short step."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.optimize import brentq

from rigidfluid.core.output.history import History

PASSED = (2.0, 1.0, 0.5)
"""Heights of the falling disk [cm]."""
FIRST, LATER = 0.02, 0.2
"""From when on drag is compared, which is infinite at a start at once [s]."""


@dataclass(frozen=True)
class Case:
    """A scene with what is changed in it, the steps of its runs, and the errors of a run against the reference."""

    scene: str
    changes: tuple[str, ...]
    reference: float
    steps: tuple[float, ...]
    longest: float
    tolerances: tuple[float, ...]
    errors: Callable[[History, History], dict[str, float]]


@dataclass(frozen=True)
class Outcome:
    """A run: its label, CPU seconds, and what it found."""

    label: str
    seconds: float
    history: History


def settings(case: Case) -> Iterator[tuple[str, list[str]]]:
    """A label and what is changed in the scene, for the reference, all fixed steps, and all tolerances."""
    yield "reference", [*case.changes, f"time.step={case.reference}"]
    for step in case.steps:
        yield f"step {step:g}", [*case.changes, f"time.step={step}"]
    for tolerance in case.tolerances:
        free = [f"time.step={case.longest}", f"time.tolerance={tolerance}"]
        yield f"tolerance {tolerance:g}", [*case.changes, *free]


def _of_the_fall(history: History, reference: History) -> dict[str, float]:
    """Of velocity over the greatest speed, height [cm], times of passage [s], and the highest Reynolds number."""
    times, velocity = history.bodies["time"], history.bodies["vy"]
    off = velocity - CubicSpline(reference.bodies["time"], reference.bodies["vy"])(times)
    away = history.bodies["y"] - _path(reference)(times)
    late = [_passes(history, height) - _passes(reference, height) for height in PASSED]
    fastest, highest = np.abs(reference.bodies["vy"]).max(), np.abs(velocity).max()
    return {
        "velocity, rms": _rms(times, off) / fastest,
        "velocity, greatest": float(np.abs(off).max()) / fastest,
        "height, greatest [cm]": float(np.abs(away).max()),
        "passage, greatest [s]": float(np.abs(late).max()),
        "highest Re": abs(float(highest / fastest) - 1.0),
    }


def _path(history: History) -> CubicHermiteSpline:
    return CubicHermiteSpline(history.bodies["time"], history.bodies["y"], history.bodies["vy"])


def _passes(history: History, height: float) -> float:
    """When the disk passes a height."""
    after, path = int(np.argmax(history.bodies["y"] <= height)), _path(history)
    bracket = history.bodies["time"][after - 1 : after + 1]
    return float(brentq(lambda time: path(time) - height, *bracket, xtol=1e-13))


def _of_the_start(history: History, reference: History) -> dict[str, float]:
    """Of the drag over its last value, and of the fluid's kinetic energy, relative."""
    times, energy = history.bodies["time"][1:], reference.energy["kinetic"][1:]
    drag = CubicSpline(reference.bodies["time"][1:], reference.bodies["fx"][1:])
    off = (history.bodies["fx"][1:] - drag(times)) / reference.bodies["fx"][-1]
    kinetic = history.energy["kinetic"][1:] - CubicSpline(reference.energy["time"][1:], energy)(times)
    later, first = times >= LATER, times >= FIRST
    return {
        f"drag from {LATER} s on, rms": _rms(times[later], off[later]),
        f"drag from {FIRST} s on, greatest": float(np.abs(off[first]).max()),
        f"kinetic energy from {LATER} s on, rms": _rms(times[later], kinetic[later]) / float(energy.max()),
    }


def _rms(times: np.ndarray, values: np.ndarray) -> float:
    return float(np.sqrt(np.trapezoid(values**2, times) / (times[-1] - times[0])))


FALLING = Case(
    "falling_disk.toml",
    ("mesh.size_body=0.025", "time.end=0.8", "output.every=0.8"),
    reference=0.00025,
    steps=(0.016, 0.008, 0.004, 0.002, 0.001, 0.0005),
    longest=0.032,
    tolerances=(1e-2, 3e-3, 1e-3, 3e-4),
    errors=_of_the_fall,
)
STARTED = Case(
    "dfg_cylinder.toml",
    ("mesh.size_body=0.006", "mesh.size=0.05", "time.end=6.4", "output.every=6.4"),
    reference=0.003125,
    steps=(0.2, 0.1, 0.05, 0.025, 0.0125, 0.00625),
    longest=0.4,
    tolerances=(1e-2, 3e-3, 1e-3, 3e-4),
    errors=_of_the_start,
)
