"""Loads that contacts must hold, estimated before a run: masses, weights and speeds of bodies, and of those on them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.kinematics import carried_sum
from rigidfluid.core.model.types import Loads
from rigidfluid.core.setup.along_strokes import fastest_given
from rigidfluid.core.setup.impact import Impetus, fastest_flow, impact_speeds, travel_speeds
from rigidfluid.core.setup.masses import Masses
from rigidfluid.core.setup.stacks import stack_loads

if TYPE_CHECKING:
    from rigidfluid.core.model.joints import Joints
    from rigidfluid.core.model.motions import Motions
    from rigidfluid.core.setup.model import Model


def build_loads(model: Model, masses: Masses, motions: Motions, joints: Joints) -> Loads:
    """Loads of all bodies; each is as heavy as all that ``motions`` and ``joints`` link with it."""
    mass = masses.mass + np.trace(masses.added, axis1=1, axis2=2) / model.dimension
    impetus = Impetus(
        mass=_sum_linked(motions, joints, mass),
        weight=_sum_linked(motions, joints, masses.weight),
        given=fastest_given(motions, model.mechanisms_by_name.values(), model.time.end),
    )
    loads = _impact_loads(model, impetus)
    if not model.wet:
        return loads
    return replace(loads, travel_speed=travel_speeds(model, impetus), flow_speed=fastest_flow(model))


def _sum_linked(motions: Motions, joints: Joints, rows: FloatArray) -> FloatArray:
    """Sum, for each body, of ``rows`` (n, …) over all bodies that a motion or joints link with it: an upper bound of
    what it hits something with."""
    whole = joints.clusters[motions.carrier]
    return carried_sum(whole, rows, int(whole.max(initial=-1)) + 1)[whole]


def _impact_loads(model: Model, impetus: Impetus) -> Loads:
    """A body of given twist is as heavy as a wall, and nothing that contacts must hold."""
    prescribed, speed = model.prescribed, impact_speeds(model, impetus)
    smallest = min((law.aim for law in model.laws), default=0.0)
    weight = np.where(prescribed, 0.0, np.linalg.norm(impetus.weight, axis=1))
    own = np.column_stack([weight, np.where(prescribed, 0.0, 0.5 * impetus.mass * speed**2)])
    position = np.array([body.position for body in model.all_bodies]).reshape(-1, model.dimension)
    radius = np.array([shape.bounding_radius for shape in model.shapes])
    together = stack_loads(own, impetus.weight, position, radius, model.domain.size)
    stacked_weight, stacked_energy = np.where(prescribed, np.inf, together.T)
    mass = np.where(prescribed, np.inf, impetus.mass)
    film, names = model.fluid.film(model.shapes), tuple(body.name for body in model.all_bodies)
    return Loads(mass, weight, speed, stacked_weight, stacked_energy, smallest, film, names=names)
