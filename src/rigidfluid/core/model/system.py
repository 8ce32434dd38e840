"""The parts of one simulation: bodies, walls, detector, law and backend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.interfaces import Body, Detector, FluidBackend, ForceLaw
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Loads, Pose, Twist
from rigidfluid.core.model.wall import Wall


@dataclass(frozen=True)
class System:
    """Everything that stays the same while a scene runs.

    ``surfaces``: names of the bodies, then of the domain's pieces; ``walls``: those pieces that repel.
    ``wall_velocity`` (s, d): at which these slide, by surface number, zero for all others; None if all rest
    [length/time].
    ``mass`` (n,) [mass], ``inertia`` (n, k, k) in the body's frame [mass·length²]; ``added_mass`` (n, d, d): what a
    fluid adds at least. ``weight`` (n, d) submerged, (m - ρV)g [force].
    ``controlled`` (n,): the twist is given, by ``controlled_twist(time)`` (n, d+k), and the pose, by
    ``controlled_pose(time)``.
    ``assembly`` (n,): equal for parts of one articulated body, which do not repel each other.
    ``interactions``: the laws with the contacts that they act in; ``law``: all of them together, None where there are
    none. ``loads``: what contacts must hold; its smallest gap is the least of all laws', and 0 without any.
    ``substeps``: of contacts in a step, None where they follow from the contacts; ``implicit``: one step, no substeps.
    ``detector_why``: who chose the detector, and for what reason. ``reach``: the largest gap that is measured [length].
    ``leverage`` (n,): of each body's surface, see `most_leverage` [1].
    """

    dimension: int
    bodies: tuple[Body, ...]
    surfaces: tuple[str, ...]
    domain: Domain
    walls: tuple[Wall, ...]
    wall_velocity: FloatArray | None
    mass: FloatArray
    added_mass: FloatArray
    inertia: FloatArray
    weight: FloatArray
    pose: Pose
    twist: Twist
    assembly: IntArray
    controlled: BoolArray
    controlled_twist: Callable[[float], FloatArray]
    controlled_pose: Callable[[float], Pose]
    backend: FluidBackend
    detector: Detector
    detector_why: str
    reach: float
    leverage: FloatArray
    interactions: tuple[Interaction, ...]
    law: ForceLaw | None
    loads: Loads
    substeps: int | None
    implicit: bool
