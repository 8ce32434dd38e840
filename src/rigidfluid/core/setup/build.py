"""A scene becomes a system: bodies, walls, detector, law and backend, ready for the loop."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache, partial

import numpy as np

from rigidfluid.core.contact.detection import detection_by
from rigidfluid.core.mechanics.carried_leverage import leverages
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.mechanics.wall_velocity import SlidingWalls
from rigidfluid.core.model.conditions import BoundaryCondition
from rigidfluid.core.model.fluid_problem import FluidProblem
from rigidfluid.core.model.interactions import acting_together
from rigidfluid.core.model.interfaces import Body, Detector, ForceLaw
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoolArray, FloatArray, IntArray, Twist
from rigidfluid.core.nested.placing import Tables, initial_pose, initial_twist
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.body_force import body_force
from rigidfluid.core.setup.boundary import conditions, repelling_walls
from rigidfluid.core.setup.geometry_checks import check_geometry
from rigidfluid.core.setup.impact import creeping_resistances
from rigidfluid.core.setup.initial_flow import initial_flow
from rigidfluid.core.setup.interactions import build_interactions
from rigidfluid.core.setup.joints import build_joints, joined_bodies
from rigidfluid.core.setup.loads import build_loads
from rigidfluid.core.setup.masses import Masses, masses_of
from rigidfluid.core.setup.parts import Parts, known_parts
from rigidfluid.core.setup.prescribed import PrescribedMotion, controlled_bodies, prescribed_motion
from rigidfluid.core.setup.window import build_window, open_wake_end

_MOST_PAIRS = 1000


def build_system(scene: Scene) -> System:
    """Build the parts of a simulation and check that they fit together.

    Raises SceneError if a body overlaps another or a surface of the domain, or the mesh is too coarse for a gap.
    """
    parts = known_parts(scene)
    scene, domain, walls = parts.scene, parts.domain, repelling_walls(parts.scene, parts.domain)
    masses = masses_of(parts)
    motions, given = _motions(parts, masses)
    pose = motions.poses(motions.pose, 0.0)
    check_geometry(scene, parts, pose)
    window = build_window(scene, parts, pose)
    problem = _problem(scene, open_wake_end(conditions(scene, domain), window), motions)
    joints = build_joints(scene, pose, motions, given, _least_resistance(parts))
    motions = motions.starting_with(joints.fitting(motions.pose, motions.twist, 0.0))
    loads = build_loads(parts, masses, motions, joints)
    surfaces = (*(body.name for body in scene.body), *domain.names)
    interactions = build_interactions(scene, parts, surfaces, loads)
    detector, law = parts.detector.part(parts.detector.options, parts.bodies, walls), acting_together(interactions)
    return System(
        dimension=scene.dimension,
        bodies=parts.bodies,
        surfaces=surfaces,
        domain=domain,
        walls=walls,
        wall_velocity=None if all(wall.velocity is None for wall in walls) else SlidingWalls(walls),
        mass=masses.mass,
        added_mass=masses.added,
        inertia=masses.inertia,
        weight=masses.weight,
        pose=pose,
        twist=motions.kinematics(motions.pose, 0.0).component_twist(motions.twist),
        motions=motions,
        joints=joints,
        assembly=_assemblies(scene),
        controlled=controlled_bodies(scene),
        controlled_twist=given,
        controlled_pose=given.pose_at,
        fluid=problem if parts.wet else None,
        backend_type=parts.backend.part,
        make_backend=cache(partial(parts.backend.part, parts.backend.options, problem)),
        detector=detector,
        detection_type=detection_by(parts.detector.part),
        detector_why=parts.detector_why,
        reach=_reach(detector, law),
        leverage=leverages(parts.bodies, motions, scene.time.end),
        interactions=interactions,
        law=law,
        loads=loads,
        substeps=scene.contact.substeps,
        implicit=scene.contact.stepping == "implicit",
        window=window,
        joined=joined_bodies(scene),
    )


def _motions(parts: Parts, masses: Masses) -> tuple[Motions, PrescribedMotion]:
    """The motions that carry the bodies, where and as they start, and those that are given."""
    scene, controlled = parts.scene, controlled_bodies(parts.scene)
    single = len(scene.body) - sum(len(mechanism.components) for mechanism in parts.mechanisms.values())
    tables: Tables = (*scene.body[:single], *scene.mechanism)
    start = initial_pose(tables, scene.dimension)
    given = prescribed_motion(scene, start)
    started = _initial_twist(initial_twist(tables, scene.dimension), controlled[:single], given(0.0))
    own = masses.mass, masses.inertia, controlled, start, started
    return (CarriedBodies(parts.mechanisms, *own) if parts.mechanisms else SingleBodies(*own)), given


def _assemblies(scene: Scene) -> IntArray:
    """A number for each body, the same for parts of one articulated body (n,)."""
    wholes: list[str | int] = [body.part_of or number for number, body in enumerate(scene.body)]
    first: dict[str | int, int] = {}
    return np.array([first.setdefault(whole, number) for number, whole in enumerate(wholes)], dtype=np.int64)


def _initial_twist(twist: Twist, controlled: BoolArray, given: FloatArray) -> Twist:
    """The motions' twist at the start, with that of the first ones ``given`` (N, d+k) where they are controlled."""
    d, held = twist.velocity.shape[1], np.zeros((len(given), 1), dtype=bool)
    held[: len(controlled), 0] = controlled
    return Twist(
        np.where(held, given[:, :d], twist.velocity),
        np.where(held, given[:, d:], twist.angular_velocity),
    )


def _least_resistance(parts: Parts) -> FloatArray | None:
    """Least resistance of a fluid without inertia to each body (n, d+k), None in any other."""
    return creeping_resistances(parts) if parts.wet and parts.scene.fluid.model == "stokes" else None


def _problem(scene: Scene, boundary: tuple[BoundaryCondition, ...], motions: Motions) -> FluidProblem | None:
    fluid = scene.fluid
    if fluid.density is None or fluid.viscosity is None:
        return None
    return FluidProblem(
        dimension=scene.dimension,
        bodies=len(scene.body),
        density=fluid.density,
        dynamic_viscosity=fluid.viscosity,
        inertia=fluid.model == "navier-stokes",
        conditions=boundary,
        source=body_force(scene),
        carrier=tuple(motions.carrier.tolist()),
        initial=initial_flow(scene),
    )


def _reach(detector: Detector, law: ForceLaw | None) -> float:
    """Detection distance [length]: the detector's preferred reach, capped at the largest gap worth measuring."""
    law_range = law.range if law else 0.0
    return min(detector.preferred_reach(law_range), _worth_measuring(detector.bodies, len(detector.walls), law_range))


def gap_reach(system: System) -> float:
    """The largest gap that is worth measuring, whatever the detector sees [length]."""
    return _worth_measuring(system.bodies, len(system.walls), system.law.range if system.law else 0.0)


def _worth_measuring(bodies: Sequence[Body], walls: int, law_range: float) -> float:
    """Among few bodies any gap; among many at most twice the largest body's size beyond the range.

    So the work grows with the number of neighbours and not of pairs.
    """
    if len(bodies) * (len(bodies) + walls) <= _MOST_PAIRS:
        return math.inf
    return law_range + 2.0 * max(body.bounding_radius for body in bodies)
