"""The parts of one simulation: bodies, walls, detector, law and backend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.interfaces import Body, Detector, FluidBackend, ForceLaw
from rigidfluid.core.model.linkage import Linkage
from rigidfluid.core.model.types import BoolArray, FloatArray, FluidProblem, IntArray, Kinematics, Loads, Pose, Twist
from rigidfluid.core.model.wall import Wall, WallVelocities
from rigidfluid.core.model.window import Window


class Mechanisms(Protocol):
    """The N motions of a system with mechanisms, and how they carry its n bodies.

    ``names``: of the mechanisms, the last of the motions. ``carrier`` (n,): the motion of each body. ``controlled``
    (N,): which motions are given. ``mass`` (N,) of all that a motion carries. ``pose``, ``twist``: of the motions at
    the start. ``driven_motions`` (N,): in which something moves relatively; ``driven``: whether there is any.
    """

    names: tuple[str, ...]
    carrier: IntArray
    controlled: BoolArray
    mass: FloatArray
    pose: Pose
    twist: Twist
    driven_motions: BoolArray
    driven: bool

    def poses(self, motions: Pose, time: float) -> Pose:
        """Pose of the bodies, where the ``motions`` are there."""

    def kinematics(self, motions: Pose, time: float) -> Kinematics:
        """G and g, where the ``motions`` are there."""

    def inertia(self, time: float) -> FloatArray:
        """Inertia of all that a motion carries, about its centre of mass and in its frame, (N, k, k) [mass·length²]."""

    def spin(self, time: float) -> FloatArray:
        """Angular momentum of the relative motion, in the motions' frames, (N, k) [mass·length²/time]."""

    def next_corner(self, time: float) -> float:
        """The first time after this at which the rate of a relative motion jumps; infinite without one [time]."""


@dataclass(frozen=True)
class System:
    """Everything that stays the same while a scene runs.

    ``surfaces``: names of the bodies, then of the domain's pieces; ``walls``: those pieces that repel.
    ``wall_velocity(surfaces, points)`` (m, d): at which these slide, zero for all other surfaces; None if all rest
    [length/time].
    ``mass`` (n,) [mass], ``inertia`` (n, k, k) in the body's frame [mass·length²]; ``added_mass`` (n, d, d): what a
    fluid adds at least. ``weight`` (n, d) submerged, (m - ρV)g [force].
    ``controlled`` (n,): the twist is given, by ``controlled_twist(time)`` (n, d+k), and the pose, by
    ``controlled_pose(time)``.
    ``fluid``: its equations and boundary conditions, None in a dry scene. ``make_backend()``: the one backend, of
    ``backend_type``.
    ``mechanisms``: which motions carry the bodies, None where each moves by itself; twists and poses that are given are
    then the motions'.
    ``linkage``: joints, held directions and springs of the motions, None where there are none.
    ``window``: the part of the domain that is meshed, None where all is.
    ``assembly`` (n,): equal for parts of one articulated body, which do not repel each other. ``joined`` (p, 2): bodies
    that a joint joins, the lower number first, which do not either.
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
    wall_velocity: WallVelocities | None
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
    fluid: FluidProblem | None
    backend_type: type[FluidBackend]
    make_backend: Callable[[], FluidBackend]
    detector: Detector
    detector_why: str
    reach: float
    leverage: FloatArray
    interactions: tuple[Interaction, ...]
    law: ForceLaw | None
    loads: Loads
    substeps: int | None
    implicit: bool
    mechanisms: Mechanisms | None = None
    window: Window | None = None
    linkage: Linkage | None = None
    joined: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))

    @property
    def controlled_motions(self) -> BoolArray:
        """Whether the twist of each motion is prescribed, (N,)."""
        return self.controlled if self.mechanisms is None else self.mechanisms.controlled

    @property
    def quasi_steady(self) -> bool:
        """Whether there is a fluid without inertia: it answers to the velocities of the moment, and remembers none."""
        return self.fluid is not None and not self.fluid.inertia

    @property
    def has_fluid(self) -> bool:
        """Whether there is a fluid around the bodies."""
        return self.fluid is not None

    @property
    def backend(self) -> FluidBackend:
        """The backend, made when it is first asked for: it may load libraries, and reports need none."""
        return self.make_backend()

    def meshed(self, pose: Pose) -> Domain:
        """The part of the domain that is meshed while the bodies are at ``pose``."""
        return self.domain if self.window is None else self.window.meshed_domain(pose)
