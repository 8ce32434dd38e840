"""A scene becomes a system: bodies, walls, detector, law and backend, ready for the loop."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from rigidfluid.core.mechanics.added_mass import added_mass
from rigidfluid.core.mechanics.carried_leverage import leverages
from rigidfluid.core.mechanics.kinematics import carried_sum
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.mechanics.wall_velocity import SlidingWalls
from rigidfluid.core.model.conditions import BoundaryCondition
from rigidfluid.core.model.fluid_problem import FluidProblem
from rigidfluid.core.model.interactions import acting_together
from rigidfluid.core.model.interfaces import Body, Detector, ForceLaw
from rigidfluid.core.model.joints import Joints
from rigidfluid.core.model.motions import Motions
from rigidfluid.core.model.system import System
from rigidfluid.core.model.types import BoolArray, Film, FloatArray, IntArray, Loads, Twist
from rigidfluid.core.nested.placing import Tables, initial_pose, initial_twist
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.along_strokes import fastest_given
from rigidfluid.core.setup.body_force import body_force
from rigidfluid.core.setup.boundary import conditions, repelling_walls
from rigidfluid.core.setup.geometry_checks import check_geometry
from rigidfluid.core.setup.impact import creeping_resistances, fastest_flow, impact_speeds, travel_speeds
from rigidfluid.core.setup.initial_flow import initial_flow
from rigidfluid.core.setup.interactions import SMALLEST_GAP, build_interactions, law_tables
from rigidfluid.core.setup.joints import build_joints, joined_bodies
from rigidfluid.core.setup.parts import Parts, known_parts
from rigidfluid.core.setup.prescribed import prescribed_motion
from rigidfluid.core.setup.stacks import stack_loads
from rigidfluid.core.setup.window import build_window, open_wake_end

_MOST_PAIRS = 1000


def build_system(scene: Scene) -> System:
    """Build the parts of a simulation and check that they fit together.

    Raises SceneError if a body overlaps another or a surface of the domain, or the mesh is too coarse for a gap.
    """
    parts = known_parts(scene)
    scene, mechanisms, domain = parts.scene, parts.mechanisms, parts.domain
    walls = repelling_walls(scene, domain)
    mass = np.array([body.density * shape.volume for body, shape in zip(scene.body, parts.bodies, strict=True)])
    inertia = mass[:, None, None] * np.array([body.unit_inertia for body in parts.bodies])
    controlled = np.array([body.fixed or body.prescribed is not None for body in scene.body])
    single = len(mass) - sum(len(mechanism.components) for mechanism in mechanisms.values())
    tables: Tables = (*scene.body[:single], *scene.mechanism)
    start = initial_pose(tables, scene.dimension)
    motion = prescribed_motion(scene, start)
    started = _initial_twist(initial_twist(tables, scene.dimension), controlled[:single], motion(0.0))
    own = mass, inertia, controlled, start, started
    motions: Motions = CarriedBodies(mechanisms, *own) if mechanisms else SingleBodies(*own)
    pose = motions.poses(start, 0.0)
    check_geometry(scene, parts, pose)
    window = build_window(scene, parts, pose)
    held = open_wake_end(conditions(scene, domain), window)
    creeping = parts.backend.part.needs_mesh and scene.fluid.model == "stokes"
    resistance = creeping_resistances(scene, domain, parts.bodies) if creeping else None
    joints = build_joints(scene, pose, motions, motion, resistance)
    started = joints.fitting(start, started, 0.0)
    motions = motions.starting_with(started)
    weight, inert = _submerged_weight(scene, parts.bodies, mass), _inert_density(scene, parts)
    added = inert * np.array([added_mass(body) for body in parts.bodies])
    moved = _sum_linked(motions, joints, mass + np.trace(added, axis1=1, axis2=2) / scene.dimension)
    pulled = _sum_linked(motions, joints, weight)
    given = fastest_given(motions, mechanisms.values(), scene.time.end)
    wet = parts.backend.part.needs_mesh
    speed = impact_speeds(scene, domain, parts.bodies, moved, pulled, wet, given)
    loads = _loads(scene, parts, controlled, moved, pulled, speed)
    if wet:
        travel = travel_speeds(scene, domain, parts.bodies, moved, pulled, given)
        loads = replace(loads, travel_speed=travel, flow_speed=fastest_flow(scene, domain))
    surfaces = (*(body.name for body in scene.body), *domain.names)
    interactions = build_interactions(scene, parts, surfaces, loads)
    problem = _problem(scene, held, motions)
    detector, law = parts.detector.part(parts.detector.options, parts.bodies, walls), acting_together(interactions)
    return System(
        dimension=scene.dimension,
        bodies=parts.bodies,
        surfaces=surfaces,
        domain=domain,
        walls=walls,
        wall_velocity=None if all(wall.velocity is None for wall in walls) else SlidingWalls(walls),
        mass=mass,
        added_mass=added,
        inertia=inertia,
        weight=weight,
        pose=pose,
        twist=motions.kinematics(start, 0.0).component_twist(started),
        motions=motions,
        joints=joints,
        assembly=_assemblies(scene),
        controlled=controlled,
        controlled_twist=motion,
        controlled_pose=motion.pose_at,
        fluid=problem if wet else None,
        backend_type=parts.backend.part,
        make_backend=cache(partial(parts.backend.part, parts.backend.options, problem)),
        detector=detector,
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


def _sum_linked(motions: Motions, joints: Joints, rows: FloatArray) -> FloatArray:
    """Sum, for each body, of ``rows`` (n, …) over all bodies that a motion or joints link with it: an upper bound of
    what it hits something with."""
    whole = joints.clusters[motions.carrier]
    return carried_sum(whole, rows, int(whole.max(initial=-1)) + 1)[whole]


def _submerged_weight(scene: Scene, bodies: Sequence[Body], mass: FloatArray) -> FloatArray:
    """(m - ρV)g with the exact volume, (n, d) [force]; the fluid carries no gravity, so buoyancy belongs here."""
    volume = np.array([body.volume for body in bodies])
    gravity = np.array(scene.fluid.gravity or [0.0] * scene.dimension)
    return np.outer(mass - (scene.fluid.density or 0.0) * volume, gravity)


def _inert_density(scene: Scene, parts: Parts) -> float:
    """Density of the fluid that bodies have to move with them; none without a fluid, or without its inertia."""
    inert = parts.backend.part.needs_mesh and scene.fluid.model == "navier-stokes"
    return (scene.fluid.density or 0.0) if inert else 0.0


def _loads(
    scene: Scene, parts: Parts, controlled: BoolArray, mass: FloatArray, weight: FloatArray, speed: FloatArray
) -> Loads:
    """A body of given twist is as heavy as a wall, and nothing that contacts must hold."""
    smallest = min((table.smallest_gap or SMALLEST_GAP * table.range for table in law_tables(scene)), default=0.0)
    pull = np.where(controlled, 0.0, np.linalg.norm(weight, axis=1))
    own = np.column_stack([pull, np.where(controlled, 0.0, 0.5 * mass * speed**2)])
    position = np.array([table.position for table in scene.body])
    radius = np.array([body.bounding_radius for body in parts.bodies])
    together = stack_loads(own, weight, position, radius, parts.domain.size)
    stacked_weight, stacked_energy = np.where(controlled, np.inf, together.T)
    mass = np.where(controlled, np.inf, mass)
    return Loads(mass, pull, speed, stacked_weight, stacked_energy, smallest, _film(scene, parts))


def _film(scene: Scene, parts: Parts) -> Film | None:
    fluid, mesh = scene.fluid, scene.mesh
    if fluid.viscosity is None or mesh is None or not parts.backend.part.needs_mesh:
        return None
    radius = np.array([equal_volume_radius(body) for body in parts.bodies])
    return Film(fluid.viscosity, radius, mesh.size_body / 2**mesh.refinements, fluid.model == "navier-stokes")


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
