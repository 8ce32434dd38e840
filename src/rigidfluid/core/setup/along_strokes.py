"""Components of mechanisms along their strokes: when they are nearest to each other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.joints.coordinates import Drive
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.mechanism import Mechanism
from rigidfluid.core.model.motions import Motions
from rigidfluid.errors import SceneError

SAMPLES = 129
"""Number of evenly spaced samples of a stroke, besides its corners."""


@dataclass(frozen=True)
class Nearest:
    """Two components that come nearest to each other, by their numbers, at a ``time`` and with a ``gap`` [length],
    negative where they overlap."""

    gap: float
    time: float
    first: int
    second: int


def times_along(mechanism: Mechanism, end: float) -> FloatArray:
    """Times of one period, or until the ``end`` if that is sooner or there is none (s,) [time]."""
    last = min(end, mechanism.period or end)
    return np.union1d(np.linspace(0.0, last, SAMPLES), np.fromiter(corners(mechanism, last), dtype=float))


def corners(moving: Mechanism | Drive, end: float) -> Iterator[float]:
    """Times at which the rate of a mechanism or stroke jumps, until the ``end``; no more than there are samples."""
    time = moving.next_corner(0.0)
    for _ in range(SAMPLES):
        if time > end:
            return
        yield time
        time = moving.next_corner(time)


def fastest_given(motions: Motions, mechanisms: Iterable[Mechanism], end: float) -> FloatArray:
    """Greatest velocity and angular velocity (n, 2) [length/time], [rad/time] that mechanisms give components about
    their own centres of mass, at the sampled times up to the ``end`` [time]; zero for single bodies."""
    driven = [mechanism for mechanism in mechanisms if mechanism.driven]
    times = [float(time) for mechanism in driven for time in times_along(mechanism, end)]
    if not times:
        return np.zeros((len(motions.carrier), 2))
    given = np.array([motions.kinematics(motions.pose, time).relative_twist for time in times])
    d = motions.pose.position.shape[1]
    return np.stack([np.linalg.norm(part, axis=2).max(axis=0) for part in (given[..., :d], given[..., d:])], axis=1)


def nearest_components(mechanism: Mechanism, end: float, detector: type[Detector]) -> Nearest | None:
    """Nearest approach of two components at the sampled times of the stroke; None for one component. The ``detector``
    needs no mesh."""
    shapes = [component.shape for component in mechanism.components]
    if len(shapes) < 2:
        return None
    finder, found = detector(detector.Options(), shapes, ()), Nearest(math.inf, 0.0, 0, 1)
    for time in times_along(mechanism, end) if mechanism.driven else (0.0,):
        contacts = finder.detect(mechanism.placement(float(time)), None, math.inf)
        worst = int(np.argmin(contacts.gap))
        if contacts.gap[worst] < found.gap:
            pair = int(contacts.body_a[worst]), int(contacts.body_b[worst])
            found = Nearest(float(contacts.gap[worst]), float(time), *pair)
    return found


def refuse_overlap_along(mechanisms: Mapping[str, Mechanism], end: float, detector: type[Detector]) -> None:
    """Raise SceneError where a stroke makes components overlap; those that do so at rest are refused as bodies are."""
    for name, mechanism in mechanisms.items():
        nearest = nearest_components(mechanism, end, detector) if mechanism.driven else None
        if nearest is not None and nearest.gap <= 0.0:
            a, b = (repr(mechanism.components[number].name) for number in (nearest.first, nearest.second))
            raise SceneError(
                f"mechanism {name!r}",
                f"components {a} and {b} that overlap by {-nearest.gap:.6g} at time {nearest.time:g} of the stroke",
                "components that stay clear of each other",
                "Shorten the stroke, or move them apart.",
            )
