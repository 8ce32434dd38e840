"""The parts of one simulation: bodies, walls, detector, law and backend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from rigidfluid.core.fluid.fluid_problem import FluidProblem
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.geometry.wall import Wall, WallVelocities
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detection import Detection
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.domain import Domain
from rigidfluid.core.model.fluid_backend import FluidBackend
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import Interaction
from rigidfluid.core.model.joints import Joints, NoJoints
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.types import Contacts, Loads, Pose, Twist
from rigidfluid.core.model.window import Window


@dataclass(frozen=True)
class System:
    """Everything that stays the same while a scene runs.

    ``surfaces``: names of the bodies, then of the domain's pieces; ``walls``: those pieces that repel.
    ``wall_velocity(surfaces, points)`` (m, d): at which these slide, zero for all other surfaces; None if all rest
    [length/time].
    ``mass`` (n,) [mass], ``inertia`` (n, k, k) in the body's frame [mass·length²]; ``added_mass`` (n, d, d): what a
    fluid adds at least. ``weight`` (n, d) submerged, (m - ρV)g [force].
    ``prescribed`` (n,): the twist is given, by ``prescribed_twist(time)`` (n, d+k), and the pose, by
    ``prescribed_pose(time)``.
    ``fluid``: its equations and boundary conditions, None in a dry scene. ``make_backend()``: the one backend, of
    ``backend_type``.
    ``motions``: those that carry the bodies; twists and poses that are given are the motions'. ``joints``: joints, held
    directions and springs of the motions.
    ``window``: the part of the domain that is meshed, None where all is.
    ``assembly`` (n,): equal for parts of one articulated body, which do not repel each other. ``joined`` (p, 2): bodies
    that a joint joins, the lower number first, which do not either.
    ``interactions``: the laws with the contacts that they act in; ``law``: all of them together, None where there are
    none. ``loads``: what contacts must hold; its smallest gap is the least of all laws', and 0 without any.
    ``substeps``: of contacts in a step, None where they follow from the contacts; ``implicit``: one step, no substeps.
    ``detection_type(system)``: by which the loop asks the ``detector``; ``detector_why``: who chose that, and for what
    reason. ``reach``: the largest gap that is measured [length].
    ``stresslets``: those of the bodies are wanted of the backend; ``boundary_forces``: those on the domain's boundary
    are; ``cell_errors``: those of the mesh's cells are.
    ``lattice``: by which bodies cross periodic surfaces and meet images of each other; no vectors where they do not.
    ``rotational_factor`` (n,): of each body's surface, see `largest_rotational_factor` [1].
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
    motions: Motions
    joints: Joints
    assembly: IntArray
    prescribed: BoolArray
    prescribed_twist: Callable[[float], FloatArray]
    prescribed_pose: Callable[[float], Pose]
    fluid: FluidProblem | None
    backend_type: type[FluidBackend]
    make_backend: Callable[[], FluidBackend]
    detector: Detector
    detection_type: Callable[[System], Detection]
    detector_why: str
    reach: float
    rotational_factor: FloatArray
    interactions: tuple[Interaction, ...]
    law: ForceLaw | None
    loads: Loads
    substeps: int | None
    implicit: bool
    lattice: Lattice
    window: Window | None = None
    joined: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    stresslets: bool = False
    boundary_forces: bool = False
    cell_errors: bool = False

    @property
    def quasi_steady(self) -> bool:
        """Tell whether there is a fluid without inertia: it answers to the present velocities, and remembers none."""
        return self.fluid is not None and not self.fluid.inertia

    @property
    def has_fluid(self) -> bool:
        """Tell whether there is a fluid around the bodies."""
        return self.fluid is not None

    @property
    def law_range(self) -> float:
        """Gap below which bodies may repel, zero without a law [length]."""
        return self.law.range if self.law else 0.0

    def acting(self, contacts: Contacts) -> IntArray:
        """Numbers of those of m contacts in which a law acts, within its range."""
        return (contacts.gap <= self.law.range).nonzero()[0] if self.law else np.zeros(0, dtype=np.int64)

    @cached_property
    def detection(self) -> Detection:
        """Detection of contacts, chosen by the detector's class."""
        return self.detection_type(self)

    @cached_property
    def balls(self) -> BoolArray:
        """Tell whether each body is a ball (n,)."""
        return np.array([body.radius is not None for body in self.bodies], dtype=bool)

    @cached_property
    def has_curved_films(self) -> bool:
        """Tell whether a law reads the curvatures of bodies that are no balls."""
        return any(interaction.law.curved for interaction in self.interactions) and not self.balls.all()

    @cached_property
    def bounding_radii(self) -> FloatArray:
        """Distance of the farthest surface point of each body from its centre of mass (n,) [length]."""
        return np.array([body.bounding_radius for body in self.bodies], dtype=float)

    @cached_property
    def volumes(self) -> FloatArray:
        """Volumes of the bodies (n,) [length^d]."""
        return np.array([body.volume for body in self.bodies], dtype=float)

    @cached_property
    def arms(self) -> FloatArray:
        """Bounding radii, but zero for balls, which turn in their place (n,) [length]."""
        return np.where(self.balls, 0.0, self.bounding_radii)

    @cached_property
    def solved_joints(self) -> Joints:
        """Joints that the fluid's solution holds: without a fluid none, as the bodies' path holds them."""
        return self.joints if self.has_fluid else NoJoints(len(self.motions.mass))

    @property
    def backend(self) -> FluidBackend:
        """The backend, made when it is first asked for: it may load libraries, and reports need none."""
        return self.make_backend()

    def meshed(self, pose: Pose) -> Domain:
        """The part of the domain that is meshed while the bodies are at ``pose``."""
        return self.domain if self.window is None else self.window.meshed_domain(pose)
