"""A model becomes a system: motions, joints, loads, laws and detector, ready for the loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np

from rigidfluid.core.contact.path.detection import DetectionOfImages, detection_by
from rigidfluid.core.geometry.arrays import BoolArray, FloatArray, IntArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.rotational_factors import rotational_factors
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.mechanics.wall_velocity import SlidingWalls
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.detector import Detector
from rigidfluid.core.model.force_law import ForceLaw
from rigidfluid.core.model.interactions import acting_together
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.signed_law import SignedLaw
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import Pose, Twist
from rigidfluid.core.nested.placing import initial_pose, initial_twist
from rigidfluid.core.setup.contact_laws import interactions_of
from rigidfluid.core.setup.geometry_checks import check_geometry
from rigidfluid.core.setup.image_checks import check_lengths
from rigidfluid.core.setup.impact import creeping_resistances
from rigidfluid.core.setup.interaction_checks import check_interactions
from rigidfluid.core.setup.joints import build_joints, joined_bodies
from rigidfluid.core.setup.loads import build_loads
from rigidfluid.core.setup.masses import Masses, masses_of
from rigidfluid.core.setup.model import Model
from rigidfluid.core.setup.prescribed import PrescribedMotion, prescribed_motion
from rigidfluid.core.setup.rigid_body import Start
from rigidfluid.core.setup.scalar import with_scalar
from rigidfluid.core.setup.window import build_window, open_wake_end

_MOST_PAIRS = 1000


def assemble(
    model: Model,
    check: Callable[[Model, Pose], None] = check_geometry,
    started: Model | None = None,
    time: float = 0.0,
) -> System:
    """Make the system of a model whose bodies are in their places at a ``time``, and ``check`` that its objects fit
    together; ``started``: the same bodies in the places where joints and springs fit, the model itself if not given.

    Raises SceneError if a body overlaps another or a surface of the domain, or the mesh is
    too coarse for a gap.
    """
    masses = masses_of(model)
    motions, given = _motions(model, masses, time)
    pose = motions.poses(motions.pose, time)
    check(model, pose)
    window = build_window(model, pose)
    problem = model.fluid.problem(open_wake_end(model.conditions, window), motions, model.domain)
    if problem is not None and model.fluid.scalar is not None:
        problem = with_scalar(problem, model.fluid.scalar, model)
    first = motions if started is None else _motions(started, masses, 0.0)[0]
    joints = build_joints(model, first.poses(first.pose, 0.0), first, given, _least_resistance(model))
    motions = motions.starting_with(joints.fitting(motions.pose, motions.twist, time))
    loads = build_loads(model, masses, motions, joints)
    interactions = interactions_of(model.named_laws, model.surfaces, loads)
    check_interactions(interactions, model.stepping, model.shapes, model.walls)
    chosen, why = model.detection
    detector, law = chosen.part(chosen.options, model.shapes, model.walls), acting_together(interactions)
    check_lengths(model.shapes, model.crossed, law.range if law else 0.0)
    if law is not None and detector.signed:
        law = SignedLaw(law)
    backend = model.fluid.backend
    return System(
        dimension=model.dimension,
        bodies=model.shapes,
        surfaces=model.surfaces,
        domain=model.domain,
        walls=model.walls,
        wall_velocity=None if all(wall.velocity is None for wall in model.walls) else SlidingWalls(model.walls),
        mass=masses.mass,
        added_mass=masses.added,
        inertia=masses.inertia,
        weight=masses.weight,
        pose=pose,
        twist=motions.kinematics(motions.pose, time).component_twist(motions.twist),
        motions=motions,
        joints=joints,
        assembly=_assemblies(model),
        prescribed=model.prescribed,
        prescribed_twist=given,
        prescribed_pose=given.pose_at,
        fluid=problem,
        backend_type=backend.part,
        make_backend=cache(partial(backend.part, backend.options, problem)),
        detector=detector,
        detection_type=DetectionOfImages if model.shapes and len(model.crossed.vectors) else detection_by(chosen.part),
        detector_why=why,
        reach=_reach(detector, law, model.crossed),
        rotational_factor=rotational_factors(model.shapes, motions, model.time.end),
        interactions=interactions,
        law=law,
        loads=loads,
        substeps=model.stepping.substeps,
        implicit=model.stepping.implicit,
        lattice=model.crossed,
        window=window,
        joined=joined_bodies(model),
        stresslets=model.output.stresslets,
        boundary_forces=model.output.walls,
        cell_errors=model.fluid.estimates_errors,
    )


def _motions(model: Model, masses: Masses, time: float) -> tuple[Motions, PrescribedMotion]:
    """The motions that carry the bodies, where and as they start at a ``time``, and those that are given."""
    wholes: tuple[Start, ...] = (*model.bodies, *model.mechanisms)
    start = initial_pose(wholes, model.dimension)
    given = prescribed_motion(model.bodies, start, time)
    single = model.prescribed[: len(model.bodies)]
    started = _initial_twist(initial_twist(wholes, model.dimension), single, given(time))
    own = masses.mass, masses.inertia, model.prescribed, start, started
    return (CarriedBodies(model.mechanisms_by_name, *own) if model.mechanisms else SingleBodies(*own)), given


def _assemblies(model: Model) -> IntArray:
    """A number for each body, the same for parts of one articulated body (n,)."""
    wholes: list[str | int] = [body.part_of or number for number, body in enumerate(model.all_bodies)]
    first: dict[str | int, int] = {}
    return np.array([first.setdefault(whole, number) for number, whole in enumerate(wholes)], dtype=np.int64)


def _initial_twist(twist: Twist, prescribed: BoolArray, given: FloatArray) -> Twist:
    """The motions' twist at the start, with that of the first ones ``given`` (N, d+k) where they are prescribed."""
    d, is_prescribed = twist.velocity.shape[1], np.zeros((len(given), 1), dtype=bool)
    is_prescribed[: len(prescribed), 0] = prescribed
    return Twist(
        np.where(is_prescribed, given[:, :d], twist.velocity),
        np.where(is_prescribed, given[:, d:], twist.angular_velocity),
    )


def _least_resistance(model: Model) -> FloatArray | None:
    """Least resistance of a fluid without inertia to each body (n, d+k), None in any other."""
    return creeping_resistances(model) if model.wet and not model.fluid.inertia else None


def _reach(detector: Detector, law: ForceLaw | None, crossed: Lattice) -> float:
    """Detection distance [length]: the detector's preferred reach, capped at the largest gap worth measuring."""
    law_range = law.range if law else 0.0
    worth = _worth_measuring(detector.bodies, len(detector.walls), law_range, crossed)
    return min(detector.preferred_reach(law_range), worth)


def gap_reach(system: System) -> float:
    """The largest gap that is worth measuring, whatever the detector sees [length]."""
    law_range = system.law.range if system.law else 0.0
    return _worth_measuring(system.bodies, len(system.walls), law_range, system.lattice)


def _worth_measuring(bodies: Sequence[Body], walls: int, law_range: float, crossed: Lattice) -> float:
    """Among few bodies any gap; among many, and where bodies have images, at most twice the largest body's size beyond
    the range.

    So the work grows with the number of neighbours and not of pairs.
    """
    if len(bodies) * (len(bodies) + walls) <= _MOST_PAIRS and not len(crossed.vectors):
        return math.inf
    return law_range + 2.0 * max((body.bounding_radius for body in bodies), default=0.0)
