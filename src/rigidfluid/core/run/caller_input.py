"""Checks of the input that a caller gives a run: a folder, processes, times, and numbers for a body."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.value_types import describe
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.scene.validation import value_text
from rigidfluid.errors import ArgumentError, SceneError
from rigidfluid.regular_file import path_of


def twist_row(dimension: int, velocity: Sequence[float] | None, angular_velocity: Sequence[float] | None) -> FloatArray:
    """Velocity and angular velocity of a body (d+k,), zero where not given; raises SceneError."""
    return _row(dimension, {"velocity": velocity, "angular_velocity": angular_velocity})


def wrench_row(dimension: int, force: Sequence[float] | None, torque: Sequence[float] | None) -> FloatArray:
    """Force and torque on a body (d+k,), zero where not given; raises SceneError."""
    return _row(dimension, {"force": force, "torque": torque})


def over_time(over: float | None, before: FloatArray, after: FloatArray) -> float:
    """Time in which a body goes from one twist (d+k,) to another, 0 for a jump; raises SceneError."""
    if over is None:
        return 0.0
    number = _time("over", over, lambda value: 0.0 < value < math.inf, "a time above 0", "Leave it out for a jump.")
    spins = before[3:], after[3:]
    if len(before) == 6 and np.any(np.abs(np.cross(*spins)) > _PARALLEL * math.prod(map(np.linalg.norm, spins))):
        found = f"{spins[1].tolist()} over a time, of a body that turns by {spins[0].tolist()}"
        remedy = "Bring it to rest first, or leave out 'over'."
        raise SceneError("angular_velocity", found, "one about the axis that it turns about", remedy)
    return number


def time_of(key: str, value: float) -> float:
    """A time, infinite ones among them; raises SceneError."""
    return _time(key, value, lambda number: not math.isnan(number), "a number")


def interval_of(key: str, value: float) -> float:
    """A finite time above 0; raises SceneError."""
    return _time(key, value, lambda number: 0.0 < number < math.inf, "a finite time above 0")


def folder_of(out: Path | None) -> Path | None:
    """Folder for the results, None for none; raises ArgumentError."""
    if out is None:
        return None
    return path_of("out", out, "a path, or None", "Give '.' for the working folder.")


def require_processes(processes: int | None, backend: FluidBackend) -> None:
    """Raise SceneError where a number of started processes is given and the ``backend`` shares a run among another."""
    if processes is None:
        return
    if not isinstance(processes, int) or isinstance(processes, bool) or processes != backend.ranks.size:
        raise SceneError(
            "fluid.backend",
            f"{backend.name!r}, which runs in {backend.ranks.size}, and {processes} processes",
            "as many processes as the backend shares a run among",
            "Start one process, without mpirun, or choose a backend for several, such as 'dolfinx'.",
        )


def require_function(key: str, value: object, allowed: str) -> None:
    """Raise ArgumentError unless a value can be called."""
    if not callable(value):
        raise ArgumentError(key, describe(value), allowed, "Give one that can be called.")


def require_truth(key: str, value: object) -> None:
    """Raise ArgumentError unless a value is True or False."""
    if not isinstance(value, bool):
        raise ArgumentError(key, describe(value), "True or False", "Give one of them.")


def _time(
    key: str,
    value: float,
    allows: Callable[[float], bool],
    allowed: str,
    remedy: str = "Give a time in the scene's unit.",
) -> float:
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not allows(number):
        raise SceneError(key, value_text(value), allowed, remedy)
    return number


def _row(dimension: int, given: dict[str, Sequence[float] | None]) -> FloatArray:
    lengths = dimension, 1 if dimension == 2 else 3
    return np.concatenate([_vector(key, given[key], length) for key, length in zip(given, lengths, strict=True)])


def _vector(key: str, value: Sequence[float] | None, length: int) -> FloatArray:
    if value is None:
        return np.zeros(length)
    try:
        vector = np.asarray(value, dtype=np.float64).reshape(-1)
    except (TypeError, ValueError, OverflowError):
        vector = np.full(length, np.nan)
    if vector.shape != (length,) or not np.isfinite(vector).all():
        numbers = "1 finite number" if length == 1 else f"{length} finite numbers"
        raise SceneError(
            key, value_text(value), numbers, "Give as many as the scene has dimensions, or axes to turn about."
        )
    return vector


_PARALLEL = 1e-9
"""Sine of an angle between axes that is rounding."""
