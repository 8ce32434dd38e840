"""Linked motions between contacts: RATTLE, dampers, and what contacts are told of their masses."""

from itertools import pairwise

import numpy as np
import pytest
from linked_bodies import ground_link, joint, linkage, masses, placed, split
from scipy.linalg import expm

from rigidfluid.core.joints.damping import damper_impulse
from rigidfluid.core.joints.jointed_dynamics import JointedDynamics
from rigidfluid.core.mechanics import matrices
from rigidfluid.core.mechanics.dynamics import DryDynamics
from rigidfluid.core.mechanics.rigid import kinetic_energy
from rigidfluid.core.mechanics.wrenches import flat, nothing
from rigidfluid.core.model.types import Pose, Twist, Wrench
from rigidfluid.errors import StepRejected

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


def chain(dimension, seed=1, weight=0.0):
    """Three bodies with two hinges, in motion."""
    pose = placed(3, dimension)
    points = 0.5 * (pose.position[:-1] + pose.position[1:])
    links = linkage(pose, [joint("hinge", 0, 1, points[0]), joint("hinge", 1, 2, points[1])])
    random = np.random.default_rng(seed).normal(size=(3, 3 if dimension == 2 else 6))
    twist = links.fitting(pose, split(random, dimension), 0.0)
    return jointed(pose, twist, links, weight)


def jointed(pose, twist, links, weight=0.0):
    count, dimension = pose.position.shape
    weights = np.full((count, dimension), weight)
    free = np.zeros(count, dtype=bool)
    return JointedDynamics(DryDynamics(pose, twist, *masses(count, dimension), weights, free, None), links, 0.0)


def steps(motion, count, size, wrench=None):
    none = wrench or nothing(motion.pose)
    for _ in range(count):
        motion.kick(none, 0.5 * size)
        motion.drift(size)
        motion.kick(none, 0.5 * size)


def energy(motion):
    return kinetic_energy(*masses(*motion.pose.position.shape), motion.pose, motion.twist)


@DIMENSIONS
def test_a_motion_that_is_turned_around_goes_back_the_way_it_came(dimension):
    there = chain(dimension, weight=0.4)
    start = there.pose
    steps(there, 40, 0.02)
    assert np.abs(there.pose.position - start.position).max() > 0.3
    back = jointed(there.pose, split(-flat(there.twist), dimension), there._linkage, 0.4)
    steps(back, 40, 0.02)
    np.testing.assert_allclose(back.pose.position, start.position, atol=1e-10)
    np.testing.assert_allclose(back.pose.orientation, start.orientation, atol=1e-10)


@DIMENSIONS
def test_energy_is_kept_to_second_order_and_joints_fit(dimension):
    errors = []
    for count in (40, 80):
        motion = chain(dimension)
        before = energy(motion)
        steps(motion, count, 0.8 / count)
        errors.append(abs(energy(motion) / before - 1.0))
        assert np.abs(motion._linkage.misfit(motion.pose, 0.0)).max() < 1e-12
        motion.drift(0.01)
        assert np.abs(motion._missing_rate()).max() < 1e-12
    assert errors[1] < 0.3 * errors[0] < 0.01


def test_a_double_pendulum_keeps_its_energy_to_second_order():
    """Two bars of length 1 that fall from lying, for 1."""
    pose = Pose(np.array([[0.5, 0.0], [1.5, 0.0]]), np.zeros((2, 1)))
    links = linkage(pose, [joint("hinge", 0, None, [0.0, 0.0]), joint("hinge", 0, 1, [1.0, 0.0])])
    errors = []
    for count in (50, 100, 200, 400, 800):
        motion, worst = jointed(pose, Twist(np.zeros((2, 2)), np.zeros((2, 1))), links, np.array([0.0, -10.0])), 0.0
        for _ in range(count):
            steps(motion, 1, 1.0 / count)
            worst = max(worst, abs(energy(motion) + 10.0 * float(np.sum(motion.pose.position[:, 1]))))
        errors.append(worst)
    assert energy(motion) > 5.0
    assert all(0.24 < finer / coarser < 0.26 for coarser, finer in pairwise(errors))


@pytest.mark.parametrize("most_full", [0, 64])
@DIMENSIONS
def test_what_contacts_are_told_of_linked_masses_is_what_kicks_do(monkeypatch, dimension, most_full):
    """With sparse matrices and with full ones."""
    monkeypatch.setattr(matrices, "MOST_FULL", most_full)
    motion = chain(dimension)
    wrench = np.random.default_rng(4).normal(size=flat(motion.twist).shape)
    expected = flat(motion.twist).ravel() + 0.1 * motion.inverse_masses(0.1) @ wrench.ravel()
    motion.kick(Wrench(wrench[:, :dimension], wrench[:, dimension:]), 0.1)
    np.testing.assert_allclose(flat(motion.twist).ravel(), expected, atol=1e-13)
    assert np.abs(wrench).max() > 0.1


@DIMENSIONS
def test_what_joints_did_adds_up_to_the_change_of_each_momentum(dimension):
    motion = chain(dimension)
    mass = masses(3, dimension)[0][:, None]
    before = mass * motion.twist.velocity
    steps(motion, 10, 0.02)
    np.testing.assert_allclose(
        motion.link_work.pushed[:, :dimension], mass * motion.twist.velocity - before, atol=1e-13
    )
    load = motion.link_work.load(0.2)
    np.testing.assert_allclose(0.2 * load.wrench, motion.link_work.pushed)
    np.testing.assert_allclose(0.2 * load.force, motion.link_work.impulse)


def test_accelerations_are_those_of_the_linked_motion():
    """A ball on a bar of length 2 that turns at 3 rad/time about its end."""
    pose = Pose(np.array([[2.0, 0.0]]), np.zeros((1, 1)))
    links = linkage(pose, [joint("hinge", 0, None, [0.0, 0.0])])
    motion = jointed(pose, Twist(np.array([[0.0, 6.0]]), np.array([[3.0]])), links)
    assert motion.max_acceleration(0.02)[0] == pytest.approx(18.0, rel=1e-3)
    assert motion.max_angular_acceleration(0.02)[0] < 1e-9
    np.testing.assert_array_equal(motion.pose.position, pose.position)


def test_a_copy_goes_its_own_way():
    motion = chain(2)
    start, work = motion.pose, motion.link_work
    steps(motion.copied(), 3, 0.02)
    assert motion.pose is start
    assert motion.link_work is work


def test_a_joint_that_is_torn_apart_is_rejected():
    """A slider whose crank's end is taken away farther than it reaches."""
    pose = Pose(np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros((2, 1)))
    given = np.array([[0.0, 0.0, 0.0], [40.0, 0.0, 0.0]])
    end = joint("hinge", 0, 1, [0.5, 0.2])
    links = linkage(pose, [end], [ground_link(0, 2, [0])], prescribed=[1], given=lambda _: given)
    held, weightless = np.array([False, True]), np.zeros((2, 2))
    free = DryDynamics(pose, split(given, 2), *masses(2, 2), weightless, held, lambda _: given)
    with pytest.raises(StepRejected, match=r"joints"):
        JointedDynamics(free, links, 0.0).drift(0.1)


@pytest.mark.parametrize("strength", [1e-6, 0.3, 40.0, 1e6])
def test_a_damper_against_a_constant_push_is_exact(strength):
    """u' = 2 - 3 c u from u = 5 on, for 0.2."""
    rate, time, end = 3.0 * strength, 0.2, 5.0 + 0.2 * 2.0
    impulse = damper_impulse(np.array([[3.0]]), np.array([1.0 / strength]), np.array([5.0]), np.array([end]), time)
    exact = 2.0 / rate + (5.0 - 2.0 / rate) * np.exp(-rate * time)
    assert end + 3.0 * impulse[0] == pytest.approx(exact, rel=1e-9, abs=1e-9)


def test_dampers_that_act_on_each_other_are_exact_together():
    delassus, compliance = np.array([[2.0, 0.7], [0.7, 1.0]]), np.array([0.5, 0.1])
    before = np.array([1.0, -2.0])
    impulse = damper_impulse(delassus, compliance, before, before, 0.3)
    np.testing.assert_allclose(before + delassus @ impulse, expm(-0.3 * delassus / compliance) @ before, rtol=1e-12)
