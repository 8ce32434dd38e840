"""How near the bodies are to anything: contacts of one pose, and each body's nearest gap."""

from __future__ import annotations

import numpy as np

from rigidfluid.core import broad_phase
from rigidfluid.core.contacts import select
from rigidfluid.core.rigid import angle_between
from rigidfluid.core.system import System
from rigidfluid.core.types import Contacts, FloatArray, Mesh, Pose


def surroundings(system: System, pose: Pose, mesh: Mesh | None) -> tuple[Contacts, FloatArray]:
    """The contacts within the law's range, and each body's nearest gap (n,), infinite beyond ``system.reach``.

    Parts of one articulated body do not touch each other, yet the gap between them counts, for the fluid there.
    """
    count = len(system.bodies)
    near = system.detector.detect(pose, mesh, system.reach)
    gaps = np.full(count, np.inf)
    np.minimum.at(gaps, near.body_a, near.gap)
    paired = near.body_b < count
    np.minimum.at(gaps, near.body_b[paired], near.gap[paired])
    inside = paired & (system.assembly[near.body_a] == system.assembly[np.minimum(near.body_b, count - 1)])
    return select(near, (near.gap <= _law_range(system)) & ~inside), gaps


def _law_range(system: System) -> float:
    return system.law.range if system.law else 0.0


def least_gaps(system: System, pose: Pose, gaps: FloatArray) -> FloatArray:
    """Each body's nearest gap (n,), and where it is not measured the most that is known to be free [length]."""
    beyond = ~np.isfinite(gaps)
    if not beyond.any():
        return gaps
    bounds = np.array([body.bounding_radius for body in system.bodies])
    free = np.maximum(broad_phase.least_gaps(pose.position, bounds, system.walls), system.reach)
    return np.where(beyond, free, gaps)


def travel(system: System, start: Pose, end: Pose) -> FloatArray:
    """How far any surface point of each body can move from one pose to another, |Δx| + R Δθ (n,) [length]."""
    moved = np.linalg.norm(end.position - start.position, axis=1)
    reach = np.array([0.0 if body.radius is not None else body.bounding_radius for body in system.bodies])
    return np.asarray(moved + reach * angle_between(start.orientation, end.orientation))
