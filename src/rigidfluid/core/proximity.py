"""How near the bodies are to anything: contacts of one pose, and each body's nearest gap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigidfluid.core import broad_phase
from rigidfluid.core.rigid import angle_between
from rigidfluid.core.system import System
from rigidfluid.core.types import BoolArray, Contacts, FloatArray, Mesh, Pose

_MOST_PAIRS = 1000


def surroundings(system: System, pose: Pose, mesh: Mesh | None) -> tuple[Contacts, FloatArray]:
    """The contacts within the law's range, and each body's nearest gap (n,), infinite where beyond `sight`."""
    count = len(system.bodies)
    near = system.detector.detect(pose, mesh, sight(system))
    gaps = np.full(count, np.inf)
    np.minimum.at(gaps, near.body_a, near.gap)
    paired = near.body_b < count
    np.minimum.at(gaps, near.body_b[paired], near.gap[paired])
    return select(near, near.gap <= _law_range(system)), gaps


def sight(system: System) -> float:
    """The largest gap that is measured [length].

    Among few bodies it is what the detector allows; among many it is at most twice the largest body's size, so that the
    work grows with the number of neighbours and not of pairs.
    """
    count, law_range = len(system.bodies), _law_range(system)
    allowed = system.detector.sight(law_range)
    if count * (count + len(system.walls)) <= _MOST_PAIRS:
        return allowed
    return min(allowed, law_range + 2.0 * max(body.bounding_radius for body in system.bodies))


def least_gaps(system: System, pose: Pose, gaps: FloatArray) -> FloatArray:
    """Each body's nearest gap (n,), and where it was beyond `sight` the most that is known to be free [length]."""
    beyond = ~np.isfinite(gaps)
    if not beyond.any():
        return gaps
    bounds = np.array([body.bounding_radius for body in system.bodies])
    free = np.maximum(broad_phase.least_gaps(pose.position, bounds, system.walls), sight(system))
    return np.where(beyond, free, gaps)


def _law_range(system: System) -> float:
    return system.law.range if system.law else 0.0


def travel(system: System, start: Pose, end: Pose) -> FloatArray:
    """How far any surface point of each body can move from one pose to another, |Δx| + R Δθ (n,) [length]."""
    moved = np.linalg.norm(end.position - start.position, axis=1)
    reach = np.array([0.0 if body.radius is not None else body.bounding_radius for body in system.bodies])
    return np.asarray(moved + reach * angle_between(start.orientation, end.orientation))


def select(contacts: Contacts, chosen: BoolArray) -> Contacts:
    """The contacts where ``chosen`` (m,) is true."""
    return replace(contacts, **{name: getattr(contacts, name)[chosen] for name in Contacts.__slots__})
