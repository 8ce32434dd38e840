"""A ball and two mechanisms, one of them a stroke, in any place and motion, without a scene."""

from __future__ import annotations

import numpy as np
from linked_bodies import placed, split
from mechanism_parts import Hammer, PairOptions, Stroke

from rigidfluid.bodies.sphere import Sphere
from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.rigid import lab_inertia, moment
from rigidfluid.core.model.body import Body
from rigidfluid.core.model.types import Pose, Twist


def carried(dimension: int, stroke: float = 0.2) -> tuple[CarriedBodies, list[Body]]:
    """The motions, which are in motion, and the bodies they carry: the ball, a hammer, one that strokes."""
    options = PairOptions(radius=0.1, length=0.6, density=2.0, ratio=3.0, stroke=stroke)
    mechanisms = {"hammer": Hammer(options, dimension), "stroke": Stroke(options, dimension)}
    parts = [part for mechanism in mechanisms.values() for part in mechanism.components]
    bodies = [Sphere(Sphere.Options(radius=0.1), dimension), *(part.shape for part in parts)]
    mass = np.array([1.0, *(part.density * part.shape.volume for part in parts)])
    inertia = mass[:, None, None] * np.array([body.unit_inertia for body in bodies])
    twist = np.random.default_rng(7).normal(size=(3, 3 if dimension == 2 else 6))
    motions = placed(3, dimension), split(twist, dimension)
    return CarriedBodies(mechanisms, mass, inertia, np.zeros(5, dtype=bool), *motions), bodies


def momenta(mass: FloatArray, inertia: FloatArray, pose: Pose, twist: Twist, centre: FloatArray) -> FloatArray:
    """Momentum of each body, and its angular momentum about ``centre`` (n, d), (n, d+k)."""
    push = mass[:, None] * twist.velocity
    own = np.einsum("nij,nj->ni", lab_inertia(inertia, pose.orientation), twist.angular_velocity)
    return np.concatenate([push, own + moment(pose.position - centre, push)], axis=1)
