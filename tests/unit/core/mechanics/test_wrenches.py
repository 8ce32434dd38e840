import numpy as np
import pytest

from rigidfluid.core.mechanics.rigid import moment
from rigidfluid.core.mechanics.wrenches import contact_wrench
from rigidfluid.core.model.types import Contacts, Pose

WALL = 3


def contacts_of(body_a: list[int], body_b: list[int], dimension: int) -> Contacts:
    random = np.random.default_rng(0)
    count = len(body_a)
    normal = random.normal(size=(count, dimension))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    gap, point_b = random.uniform(0.1, 1, count), random.normal(size=(count, dimension))
    unknown = np.full(count, np.nan)
    point_a = point_b + gap[:, None] * normal
    return Contacts(
        np.array(body_a, dtype=np.int64),
        np.array(body_b, dtype=np.int64),
        point_a,
        point_b,
        normal,
        gap,
        unknown,
        unknown,
        np.array(body_b) >= 3,
    )


def pose_of(dimension: int) -> Pose:
    position = np.random.default_rng(1).normal(size=(3, dimension))
    return Pose(position, np.tile(np.eye(1, 1 if dimension == 2 else 4), (3, 1)))


@pytest.mark.parametrize("dimension", [2, 3])
def test_bodies_among_themselves_gain_no_momentum(dimension: int) -> None:
    contacts, pose = contacts_of([0, 0, 1], [1, 2, 2], dimension), pose_of(dimension)
    wrench = contact_wrench(contacts, contacts.normal * np.array([[1.0], [2.0], [3.0]]), pose)
    np.testing.assert_allclose(wrench.force.sum(axis=0), 0.0, rtol=0, atol=1e-14)
    about_origin = moment(pose.position, wrench.force) + wrench.torque
    np.testing.assert_allclose(about_origin.sum(axis=0), 0.0, rtol=0, atol=1e-14)
    assert np.linalg.norm(wrench.torque, axis=1).min() > 0.1


def test_both_sides_take_force_and_moment_half_way_between_their_points() -> None:
    here = np.array([[1.0, 0.0]])
    there = np.array([[2.0, 0.0]])
    one = np.array([1.0])
    contacts = Contacts(np.array([0]), np.array([1]), here, there, here, -one, one, one, np.array([False]))
    pose = Pose(np.array([[0.0, 0.0], [5.0, 0.0]]), np.zeros((2, 1)))
    wrench = contact_wrench(contacts, np.array([[0.0, 10.0]]), pose)
    np.testing.assert_allclose(wrench.force, [[0.0, 10.0], [0.0, -10.0]])
    np.testing.assert_allclose(wrench.torque, [[15.0], [35.0]])


@pytest.mark.parametrize("dimension", [2, 3])
def test_forces_along_the_surfaces_turn_nothing_on_the_whole(dimension: int) -> None:
    contacts, pose = contacts_of([0, 0, 1], [1, 2, 2], dimension), pose_of(dimension)
    wrench = contact_wrench(contacts, np.random.default_rng(3).normal(size=(3, dimension)), pose)
    about_origin = moment(pose.position, wrench.force) + wrench.torque
    np.testing.assert_allclose(about_origin.sum(axis=0), 0.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_wall_takes_its_share_away(dimension: int) -> None:
    contacts, pose = contacts_of([0, 2], [WALL, WALL + 1], dimension), pose_of(dimension)
    wrench = contact_wrench(contacts, contacts.normal, pose)
    np.testing.assert_array_equal(wrench.force, [contacts.normal[0], np.zeros(dimension), contacts.normal[1]])
    assert wrench.force.shape == (3, dimension)


def test_many_contacts_on_one_body_add_up() -> None:
    contacts = contacts_of([0, 0, 0], [WALL, WALL, WALL], 2)
    wrench = contact_wrench(contacts, np.ones((3, 2)), pose_of(2))
    np.testing.assert_allclose(wrench.force, [[3.0, 3.0], [0.0, 0.0], [0.0, 0.0]])


def test_no_contacts_no_wrench() -> None:
    wrench = contact_wrench(contacts_of([], [], 3), np.zeros((0, 3)), pose_of(3))
    assert not wrench.force.any()
    assert wrench.torque.shape == (3, 3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_couple_turns_a_and_b_against_each_other_and_moves_none(dimension: int) -> None:
    contacts, pose = contacts_of([0, 0, 1], [1, 2, WALL], dimension), pose_of(dimension)
    couple = np.random.default_rng(4).normal(size=(3, 1 if dimension == 2 else 3))
    force = np.random.default_rng(3).normal(size=(3, dimension))
    alone, both = contact_wrench(contacts, force, pose), contact_wrench(contacts, force, pose, couple)
    np.testing.assert_array_equal(both.force, alone.force)
    added = [couple[0] + couple[1], couple[2] - couple[0], -couple[1]]
    np.testing.assert_allclose(both.torque - alone.torque, added, rtol=0, atol=1e-14)
