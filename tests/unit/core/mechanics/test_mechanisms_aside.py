"""A mechanism whose parts move across the line between them, and turn about different axes."""

from __future__ import annotations

import numpy as np
import pytest
from carried_bodies import momenta
from linked_bodies import placed, split
from mechanism_parts import PairOptions, Stroke

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.component_dynamics import ComponentDynamics
from rigidfluid.core.mechanics.driven_dynamics import DrivenDynamics
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.types import Pose, Twist, Wrench

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])
TIME = 0.3


class Aside(Stroke):
    """A stroke whose head swings across as well, in a motion of its own."""

    def placement(self, time: float) -> Pose:
        pose = super().placement(time)
        pose.position[1, 1] += 0.3 * np.cos(5.0 * time)
        return pose

    def rate(self, time: float) -> Twist:
        twist = super().rate(time)
        twist.velocity[1, 1] -= 1.5 * np.sin(5.0 * time)
        return twist


def aside(dimension: int) -> CarriedBodies:
    mechanism = Aside(PairOptions(radius=0.1, length=0.6, density=2.0, ratio=3.0, stroke=0.2), dimension)
    mass = np.array([part.density * part.shape.volume for part in mechanism.components])
    inertia = mass[:, None, None] * np.array([part.shape.unit_inertia for part in mechanism.components])
    twist = np.random.default_rng(7).normal(size=(1, 3 if dimension == 2 else 6))
    motions = placed(1, dimension, seed=2), split(twist, dimension)
    return CarriedBodies({"it": mechanism}, mass, inertia, np.zeros(2, dtype=bool), *motions)


def angular_momentum(motions: CarriedBodies, place: Pose, twist: Twist, time: float) -> FloatArray:
    """Sum over both bodies, about the common centre of mass."""
    pose, each = motions.poses(place, time), motions.kinematics(place, time).component_twist(twist)
    own = motions._own_mass, motions._own_inertia
    both = momenta(*own, pose, each, place.position[motions.carrier])
    return np.asarray(both[:, place.position.shape[1] :].sum(axis=0))


@DIMENSIONS
def test_what_moves_within_turns_the_whole_the_other_way(dimension: int) -> None:
    motions = aside(dimension)
    none = np.zeros((1, dimension))
    body = DrivenDynamics(motions.pose, motions.twist, motions, none, TIME, lambda _: none)
    before = angular_momentum(motions, motions.pose, motions.twist, TIME)
    for _ in range(4):
        body.drift(0.05)
    now = angular_momentum(motions, body.pose, body.twist, TIME + 0.2)
    np.testing.assert_allclose(now, before, atol=1e-12)
    assert np.abs(body.twist.angular_velocity - motions.twist.angular_velocity).max() > 0.1


@DIMENSIONS
def test_a_body_gives_way_to_a_push_as_it_says(dimension: int) -> None:
    """Along any direction, and across it too."""
    motions = aside(dimension)
    own = motions.mass, motions.inertia(0.0), np.zeros((1, dimension)), motions.prescribed
    random = np.random.default_rng(4).normal(size=dimension)
    direction = random / np.linalg.norm(random)
    for number in range(2):
        body = ComponentDynamics(DryDynamics(motions.pose, motions.twist, *own, lambda _: np.zeros(0)), motions, 0.0)
        start, push = body.twist.velocity[number], nothing(body.pose)
        told = body.inverse_mass[number] @ direction
        along = body.inverse_mass_along(np.array([number]), direction[None])[0]
        push.force[number] = direction
        body.kick(Wrench(push.force, push.torque), 1.0)
        np.testing.assert_allclose(body.twist.velocity[number] - start, told, atol=1e-10 * np.abs(told).max())
        assert direction @ told == pytest.approx(along)
