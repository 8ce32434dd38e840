"""Motions that carry bodies: velocities, momenta, energies and work are those of the bodies, one by one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from carried_bodies import carried, momenta
from linked_bodies import split

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.actuators import BodiesAfter, actuator_work
from rigidfluid.core.mechanics.component_dynamics import ComponentDynamics
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.kinematics import carried_sum
from rigidfluid.core.mechanics.mechanisms import CarriedBodies
from rigidfluid.core.mechanics.motions import (
    applied_wrench,
    body_accelerations,
    newly_applied,
    round_motions,
    twist_arms,
)
from rigidfluid.core.mechanics.rigid import kinetic_energy, moment, rotate, rotation_between, turned
from rigidfluid.core.mechanics.rotational_factors import rotational_factors
from rigidfluid.core.mechanics.time_scheme import momentum
from rigidfluid.core.mechanics.wrenches import flat, nothing, power
from rigidfluid.core.model.types import Pose, Twist, Wrench

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])
TIME, SHORT = 0.3, 1e-4


def later(pose: Pose, twist: Twist, time: float) -> Pose:
    return Pose(pose.position + time * twist.velocity, rotate(pose.orientation, time * twist.angular_velocity))


def rates(start: Pose, end: Pose, time: float) -> FloatArray:
    turn = rotation_between(start.orientation, end.orientation)
    return np.concatenate([end.position - start.position, turn], axis=1) / time


def wrench_on(bodies: int, dimension: int, seed: int = 3) -> Wrench:
    rows = split(np.random.default_rng(seed).normal(size=(bodies, 3 if dimension == 2 else 6)), dimension)
    return Wrench(rows.velocity, rows.angular_velocity)


@DIMENSIONS
def test_velocities_of_bodies_are_the_rates_of_their_poses(dimension: int) -> None:
    motions, _ = carried(dimension)
    before, after = (
        motions.poses(later(motions.pose, motions.twist, way), TIME + way) for way in (-0.5 * SHORT, 0.5 * SHORT)
    )
    kinematics = motions.kinematics(motions.pose, TIME)
    twist = kinematics.component_twist(motions.twist)
    np.testing.assert_allclose(flat(twist), rates(before, after, SHORT), atol=1e-6)
    np.testing.assert_allclose(kinematics.motion_twist(flat(twist)), flat(motions.twist), atol=1e-12)


@DIMENSIONS
def test_power_on_bodies_is_that_on_their_motions_and_that_of_drives(dimension: int) -> None:
    motions, _ = carried(dimension)
    kinematics, wrench = motions.kinematics(motions.pose, TIME), wrench_on(5, dimension)
    whole = power(wrench, kinematics.component_twist(motions.twist)).sum()
    by_drives = np.sum(flat(wrench) * kinematics.relative_twist)
    assert power(kinematics.motion_wrench(wrench), motions.twist).sum() + by_drives == pytest.approx(whole)
    assert abs(by_drives) > 0.1


@DIMENSIONS
def test_bodies_are_accelerated_as_their_velocities_change(dimension: int) -> None:
    """By the motions, at a moment without relative motion."""
    motions, _ = carried(dimension, stroke=0.0)
    rate = np.random.default_rng(5).normal(size=flat(motions.twist).shape)
    rigid = motions.kinematics(motions.pose, 0.25)  # where the head stops and turns back

    def velocity(way: float) -> FloatArray:
        twist = split(flat(motions.twist) + way * rate, dimension)
        return flat(motions.kinematics(later(motions.pose, motions.twist, way), 0.25).component_twist(twist))

    found = rigid.body_rates(rate, motions.twist, np.zeros_like(rigid.relative_twist))
    np.testing.assert_allclose(found, (velocity(0.5 * SHORT) - velocity(-0.5 * SHORT)) / SHORT, atol=1e-5)


@DIMENSIONS
def test_strokes_accelerate_bodies_by_the_mean_over_the_time(dimension: int) -> None:
    motions, _ = carried(dimension)
    still = split(np.zeros_like(flat(motions.twist)), dimension)
    motions.twist = still
    none = nothing(motions.pose)
    state: Any = SimpleNamespace(
        past=SimpleNamespace(twist=still, step=0.1, applied=None),
        motions=SimpleNamespace(pose=motions.pose, twist=still, contact=none),
        pose=motions.poses(motions.pose, TIME),
        applied=None,
    )
    system: Any = SimpleNamespace(
        motions=motions, mass=np.ones(5), added_mass=np.zeros((5, dimension, dimension)), dimension=dimension
    )
    found = body_accelerations(system, state, TIME, 0.05)
    times = TIME, TIME + 0.05
    before, after = (flat(motions.kinematics(motions.pose, time).component_twist(still)) for time in times)
    np.testing.assert_allclose(found, (after - before) / 0.05, atol=1e-9)
    assert np.abs(found).max() > 0.1


@DIMENSIONS
def test_momenta_and_energy_of_motions_are_those_of_their_bodies(dimension: int) -> None:
    motions, _ = carried(dimension)
    mass, inertia = motions._own_mass, motions._own_inertia
    pose = motions.poses(motions.pose, TIME)
    twist = motions.kinematics(motions.pose, TIME).component_twist(motions.twist)
    centre = motions.pose.position[motions.carrier]
    each = carried_sum(motions.carrier, momenta(mass, inertia, pose, twist, centre), 3)
    own = momentum(motions.mass, motions.inertia(TIME), motions.pose, motions.twist)
    own[:, dimension:] += turned(motions.pose.orientation, motions.spin(TIME))
    np.testing.assert_allclose(own, each, atol=1e-12)
    places = mass[:, None] * (pose.position - centre)
    np.testing.assert_allclose(carried_sum(motions.carrier, places, 3), 0.0, atol=1e-14)


@DIMENSIONS
def test_inverse_masses_are_those_of_the_energy_also_with_the_fluids(dimension: int) -> None:
    """Of a motion that goes straight, and of one that turns about its centre of mass."""
    motions, _ = carried(dimension)
    added = np.random.default_rng(2).normal(size=(5, dimension, dimension))
    mass = motions._own_mass[:, None, None] * np.eye(dimension) + 0.1 * added @ np.swapaxes(added, 1, 2)
    bodies = motions.poses(motions.pose, TIME)
    linear, angular = motions.inverse_masses(mass, bodies, motions.pose.position)
    kinematics = motions.kinematics(motions.pose, TIME)
    for inverse, part in ((linear, slice(None, dimension)), (angular, slice(dimension, None))):
        rows = np.zeros_like(flat(motions.twist))
        rows[:, part] = flat(motions.twist)[:, part]
        moved = flat(kinematics.component_twist(split(rows, dimension))) - kinematics.relative_twist
        twist = split(moved, dimension)
        energy = 0.5 * np.einsum("ni,nij,nj->n", twist.velocity, mass, twist.velocity)
        for body in range(5):
            one = slice(body, body + 1)
            spinning = Twist(np.zeros((1, dimension)), twist.angular_velocity[one])
            place = Pose(bodies.position[one], bodies.orientation[one])
            energy[body] += kinetic_energy(np.ones(1), motions._own_inertia[one], place, spinning)
        whole = 0.5 * np.einsum("ni,nij,nj->n", rows[:, part], np.linalg.inv(inverse), rows[:, part])
        np.testing.assert_allclose(whole, carried_sum(motions.carrier, energy, 3))


@DIMENSIONS
def test_the_farthest_point_of_a_motion_gives_its_arm(dimension: int) -> None:
    motions, bodies = carried(dimension)
    reach = np.array([body.bounding_radius for body in bodies])
    balls = np.array([body.radius is not None for body in bodies])
    system: Any = SimpleNamespace(motions=motions, bounding_radii=reach, balls=balls, dimension=dimension)
    arms, pose = twist_arms(system), motions.poses(motions.pose, 0.0)
    np.testing.assert_array_equal(arms[:, :dimension], 1.0)
    farthest = np.linalg.norm(pose.position - motions.pose.position[motions.carrier], axis=1) + reach
    expected = [farthest[:1].max(), farthest[1:3].max(), farthest[3:].max()]
    np.testing.assert_allclose(arms[:, dimension:], np.repeat(expected, arms.shape[1] - dimension).reshape(3, -1))
    assert round_motions(system).tolist() == [True, False, False]


@DIMENSIONS
def test_a_wrench_from_outside_turns_motions_by_its_mean_lever(dimension: int) -> None:
    """Of a stroke, whose bodies are elsewhere at the end of the step."""
    motions, _ = carried(dimension)
    force, now = wrench_on(5, dimension), split(np.zeros_like(flat(motions.twist)), dimension)
    twist = motions.kinematics(motions.pose, TIME).component_twist(now)
    state: Any = SimpleNamespace(
        applied=force,
        past=SimpleNamespace(applied=Wrench(0.25 * np.ones((3, dimension)), 0.5 * np.ones_like(now.angular_velocity))),
        motions=SimpleNamespace(pose=motions.pose, twist=now),
        pose=motions.poses(motions.pose, TIME),
        twist=twist,
    )
    system: Any = SimpleNamespace(motions=motions, dimension=dimension)
    found = applied_wrench(system, state, motions.kinematics(motions.pose, TIME + 0.4))
    levers = [
        moment(motions.poses(motions.pose, time).position - motions.pose.position[motions.carrier], force.force)
        for time in (TIME, TIME + 0.4)
    ]
    torque = carried_sum(motions.carrier, force.torque + 0.5 * (levers[0] + levers[1]), 3)
    np.testing.assert_allclose(found.force, carried_sum(motions.carrier, force.force, 3))
    np.testing.assert_allclose(found.torque, torque, atol=1e-12)
    new, here = newly_applied(system, state), carried_sum(motions.carrier, force.torque + levers[0], 3)
    np.testing.assert_allclose(new.force, found.force - 0.25)
    np.testing.assert_allclose(new.torque, here - 0.5, atol=1e-12)


def lifted(weight: float, applied: float | None, end_speed: float) -> float:
    """Work of the drive that moves the second of two bodies away from the first along the first axis in a step of .1,
    at the speed 2 at its start, with mass 3 and this weight, and this force on it besides."""
    place, rest = Pose(np.zeros((2, 2)), np.zeros((2, 1))), np.zeros((2, 1))
    start, end = (np.array([[0.0, 0.0], [speed, 0.0]]) for speed in (2.0, end_speed))

    def kinematics(velocity: FloatArray) -> Any:
        return SimpleNamespace(relative_twist=np.concatenate([velocity, rest], axis=1))

    motions = SimpleNamespace(driven=True, kinematics_between=lambda *_: kinematics(start))
    system: Any = SimpleNamespace(
        motions=motions, mass=np.array([1.0, 3.0]), inertia=np.ones((2, 1, 1)), dimension=2,
        weight=np.array([[0.0, 0.0], [weight, 0.0]]),
    )  # fmt: skip
    given = None if applied is None else Wrench(np.array([[0.0, 0.0], [applied, 0.0]]), rest)
    now = SimpleNamespace(pose=place, twist=Twist(start, rest))
    state: Any = SimpleNamespace(pose=place, twist=Twist(start, rest), motions=now, applied=given)
    return actuator_work(system, state, BodiesAfter(place, Twist(end, rest), 0.1), kinematics(end))


def test_drives_lift_weights_hold_against_forces_and_give_bodies_their_energy() -> None:
    """At a constant speed 2 for .1 a weight of -5 takes 1, and a force of 5 gives it back; from 2 to 4 a mass of 3
    gains 18."""
    assert lifted(-5.0, None, 2.0) == pytest.approx(1.0)
    assert lifted(-5.0, 5.0, 2.0) == pytest.approx(0.0, abs=1e-14)
    assert lifted(0.0, None, 4.0) == pytest.approx(18.0)


def dynamics(motions: CarriedBodies, dimension: int, load: Wrench | None) -> ComponentDynamics:
    force = np.zeros((3, dimension)) if load is None else motions.sums(load.force)
    own = motions.mass, motions.inertia(0.0), force, motions.prescribed, None
    return ComponentDynamics(DryDynamics(motions.pose, motions.twist, *own), motions, 0.0, load)  # type: ignore[arg-type]


@DIMENSIONS
def test_a_load_turns_what_carries_it_and_contacts_leave_their_torque(dimension: int) -> None:
    motions, _ = carried(dimension)
    load, wrench = wrench_on(5, dimension), wrench_on(5, dimension, seed=4)
    load.torque[:] = 0.0
    both = dynamics(motions, dimension, load)
    kinematics = motions.kinematics(motions.pose, 0.0)
    start = momentum(motions.mass, motions.inertia(0.0), motions.pose, motions.twist)
    both.kick(wrench, 0.1)
    end = momentum(motions.mass, motions.inertia(0.0), motions.pose, both.motion_twist)
    pushed = flat(kinematics.motion_wrench(wrench))
    np.testing.assert_allclose(end - start, 0.1 * (pushed + flat(kinematics.motion_wrench(load))), atol=1e-12)
    np.testing.assert_allclose(flat(both.motions(nothing(motions.pose)).contact), 0.1 * pushed, atol=1e-12)


@DIMENSIONS
def test_no_body_is_accelerated_by_more_than_contacts_are_told(dimension: int) -> None:
    """Nor is much less told where a motion that does not fall turns about its centre of mass."""
    motions, _ = carried(dimension, stroke=0.0)
    load = wrench_on(5, dimension)
    load.torque[:] = 0.0
    for given in (None, load):
        body = dynamics(motions, dimension, given)
        told = body.max_acceleration(SHORT)
        before = body.twist.velocity
        body.kick(nothing(body.pose), 0.5 * SHORT)
        body.drift(SHORT)
        body.kick(nothing(body.pose), 0.5 * SHORT)
        found = np.linalg.norm(body.twist.velocity - before, axis=1) / SHORT
        assert np.all(found <= told + 1e-3)
        assert np.all(found[1:3] > 0.1 * told[1:3])


def test_a_component_gives_way_as_far_out_as_the_whole_reaches() -> None:
    """m r²/I of the whole at the farthest point of its surface, and of a stroke where it is longest."""
    motions, bodies = carried(2, stroke=0.2)
    found = rotational_factors(bodies, motions, 1.0)
    assert found[0] == 0.0
    for body, mechanism in ((1, 1), (3, 2)):
        most = 0.0
        for time in np.linspace(0.0, 1.0, 33):
            arm = motions.poses(motions.pose, time).position[body] - motions.pose.position[mechanism]
            far = np.linalg.norm(arm) + bodies[body].bounding_radius
            most = max(most, motions.mass[mechanism] * far**2 / motions.inertia(time)[mechanism, 0, 0])
        assert found[body] == pytest.approx(most, rel=1e-3)
    assert found[3] > 1.03 * found[1]
