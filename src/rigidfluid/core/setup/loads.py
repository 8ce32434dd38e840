"""Loads that contacts must hold, estimated before a run: masses, weights and speeds of bodies, and of those on them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.mechanics.kinematics import carried_sum
from rigidfluid.core.mechanics.shapes import equal_volume_radius
from rigidfluid.core.model.types import Film, FloatArray, Loads
from rigidfluid.core.setup.along_strokes import fastest_given
from rigidfluid.core.setup.impact import Impetus, fastest_flow, impact_speeds, travel_speeds
from rigidfluid.core.setup.interactions import SMALLEST_GAP, law_tables
from rigidfluid.core.setup.masses import Masses
from rigidfluid.core.setup.prescribed import controlled_bodies
from rigidfluid.core.setup.stacks import stack_loads

if TYPE_CHECKING:
    from rigidfluid.core.model.joints import Joints
    from rigidfluid.core.model.motions import Motions
    from rigidfluid.core.setup.parts import Parts


def build_loads(parts: Parts, masses: Masses, motions: Motions, joints: Joints) -> Loads:
    """Loads of all bodies; each is as heavy as all that ``motions`` and ``joints`` link with it."""
    scene = parts.scene
    mass = masses.mass + np.trace(masses.added, axis1=1, axis2=2) / scene.dimension
    impetus = Impetus(
        mass=_sum_linked(motions, joints, mass),
        weight=_sum_linked(motions, joints, masses.weight),
        given=fastest_given(motions, parts.mechanisms.values(), scene.time.end),
    )
    loads = _impact_loads(parts, impetus)
    if not parts.wet:
        return loads
    return replace(loads, travel_speed=travel_speeds(parts, impetus), flow_speed=fastest_flow(scene, parts.domain))


def _sum_linked(motions: Motions, joints: Joints, rows: FloatArray) -> FloatArray:
    """Sum, for each body, of ``rows`` (n, …) over all bodies that a motion or joints link with it: an upper bound of
    what it hits something with."""
    whole = joints.clusters[motions.carrier]
    return carried_sum(whole, rows, int(whole.max(initial=-1)) + 1)[whole]


def _impact_loads(parts: Parts, impetus: Impetus) -> Loads:
    """A body of given twist is as heavy as a wall, and nothing that contacts must hold."""
    scene, controlled, speed = parts.scene, controlled_bodies(parts.scene), impact_speeds(parts, impetus)
    smallest = min((table.smallest_gap or SMALLEST_GAP * table.range for table in law_tables(scene)), default=0.0)
    pull = np.where(controlled, 0.0, np.linalg.norm(impetus.weight, axis=1))
    own = np.column_stack([pull, np.where(controlled, 0.0, 0.5 * impetus.mass * speed**2)])
    position = np.array([table.position for table in scene.body])
    radius = np.array([body.bounding_radius for body in parts.bodies])
    together = stack_loads(own, impetus.weight, position, radius, parts.domain.size)
    stacked_weight, stacked_energy = np.where(controlled, np.inf, together.T)
    mass = np.where(controlled, np.inf, impetus.mass)
    return Loads(mass, pull, speed, stacked_weight, stacked_energy, smallest, _film(parts))


def _film(parts: Parts) -> Film | None:
    fluid, mesh = parts.scene.fluid, parts.scene.mesh
    if not (parts.wet and mesh and fluid.viscosity):
        return None
    radius = np.array([equal_volume_radius(body) for body in parts.bodies])
    return Film(fluid.viscosity, radius, mesh.size_body / 2**mesh.refinements, fluid.model == "navier-stokes")
