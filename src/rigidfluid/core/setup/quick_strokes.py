"""Strokes and drives that are too quick for the steps: a step would go past their turns without meeting them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.coordinates import Drive
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.setup.along_strokes import corners
from rigidfluid.errors import SceneError

if TYPE_CHECKING:
    from rigidfluid.core.scene.run_tables import TimeTable

_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
_SAMPLES = 400
_FEWEST_STEPS = 8
"""Least number of steps for which motion that does not repeat is sampled."""


def refuse_quick_mechanisms(mechanisms: Mapping[str, Mechanism], time: TimeTable) -> None:
    """Raise SceneError where components could go all of their way, to and fro, within a step."""
    for name, mechanism in mechanisms.items():
        if mechanism.driven:
            times = _times(mechanism, time)
            values = np.array([mechanism.placement(float(at)).position.ravel() for at in times])
            rates = np.array([mechanism.rate(float(at)).velocity.ravel() for at in times])
            _refuse(f"mechanism {name!r}", mechanism, values, rates, time)


def refuse_quick_drive(drive: Drive, joint: str, time: TimeTable) -> None:
    """Raise SceneError where a drive could go all of its way within a step."""
    times = _times(drive, time)
    values, rates = (np.array([[found(float(at))] for at in times]) for found in (drive.value, drive.rate))
    _refuse(f"the drive of joint {joint!r}", drive, values, rates, time)


def _times(moving: Mechanism | Drive, time: TimeTable) -> FloatArray:
    """Sample times (s,) of a period [time]: its corners, and points that no oscillation meets always in the same
    phase."""
    last = moving.period or max(time.end, _FEWEST_STEPS * time.step)
    spread = last * (np.arange(_SAMPLES) * _GOLDEN % 1.0)
    return np.concatenate([spread, np.fromiter(corners(moving, last), dtype=float)])


def _refuse(what: str, moving: Mechanism | Drive, values: FloatArray, rates: FloatArray, time: TimeTable) -> None:
    """Raise SceneError if a step, or with corners, at which steps end, the shortest step, is too long for the motion's
    way."""
    way, speed = np.ptp(values, axis=0), np.abs(rates).max(axis=0)
    least = float(np.min(way[speed > 0.0] / speed[speed > 0.0], initial=np.inf))
    key = "shortest" if np.isfinite(moving.next_corner(0.0)) else "step"
    found = getattr(time, key)
    if found > least:
        raise SceneError(
            f"time.{key}",
            f"{found:g}, in which {what} at its fastest goes more than all of its way",
            f"at most {least:.3g}",
            "Shorten it, or slow the motion down.",
        )
