"""The parts of one simulation, built from a scene: bodies, walls, detector, law and backend, ready for the loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rigidfluid.core.interfaces import Body, Detector, FluidBackend, ForceLaw
from rigidfluid.core.types import BoolArray, FloatArray, Pose, Twist, Wall


@dataclass(frozen=True)
class System:
    """Everything that stays the same while a scene runs.

    ``surfaces``: names of the bodies, then of the domain's faces (left, right, bottom, top[, back, front]).
    ``mass`` (n,) [mass], ``inertia`` (n, k, k) in the body's frame [mass·length²], ``weight`` (n, d) submerged,
    (m - ρV)g [force]. ``controlled`` (n,): the twist is given, by ``controlled_twist(time)`` (n, d+k).
    ``lower``, ``upper`` (d,): corners of the box. ``law`` is None in a scene without contact forces.
    """

    dimension: int
    bodies: tuple[Body, ...]
    surfaces: tuple[str, ...]
    walls: tuple[Wall, ...]
    lower: FloatArray
    upper: FloatArray
    mass: FloatArray
    inertia: FloatArray
    weight: FloatArray
    pose: Pose
    twist: Twist
    controlled: BoolArray
    controlled_twist: Callable[[float], FloatArray]
    backend: FluidBackend
    detector: Detector
    law: ForceLaw | None
