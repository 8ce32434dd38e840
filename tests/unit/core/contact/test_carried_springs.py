"""Tangential springs go with their contacts, and turn with the normals."""

from dataclasses import replace

import numpy as np
import pytest

from rigidfluid.core.contact.pairs.carried_springs import carried_springs, springs_at, transported
from rigidfluid.core.mechanics.rigid import rotation_matrices
from rigidfluid.core.model.contacts import select
from rigidfluid.core.model.types import Contacts, Pose

POSE = Pose(np.array([[0.0, 0.0], [3.0, 0.0]]), np.array([[0.3], [-0.2]]))


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def carried_displacement(springs, contacts, pose):
    return carried_springs(springs, contacts, pose)[0]


def corners(points, pose=POSE, body=0, wall=2):
    """Contacts of one body's points with a wall below it."""
    count = len(points)
    foot = np.column_stack([points[:, 0], np.full(count, -1.0)])
    normal, which = np.tile([0.0, 1.0], (count, 1)), np.full(count, body)
    gap, unknown = points[:, 1] + 1.0, np.full(count, np.nan)
    return Contacts(
        which, np.full(count, wall), points, foot, normal, gap, unknown, unknown, np.ones(count, dtype=bool), unknown
    )


@pytest.mark.parametrize("dimension", [2, 3])
def test_transport_keeps_lengths_and_angles(dimension):
    random = np.random.default_rng(1)
    before, after = unit(random.normal(size=(20, dimension))), unit(random.normal(size=(20, dimension)))
    displacement = random.normal(size=(20, dimension))
    displacement -= np.sum(displacement * before, axis=1)[:, None] * before
    there = transported(displacement, before, after)
    np.testing.assert_allclose(np.sum(there * after, axis=1), 0.0, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(there, axis=1), np.linalg.norm(displacement, axis=1))
    np.testing.assert_allclose(transported(there, after, before), displacement, atol=1e-12)


@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-9])
def test_transport_to_the_opposite_normal_is_finite(off):
    before, displacement = np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 2.0]])
    after = unit(np.array([[off, -1.0, 0.0]]))
    there = transported(displacement, before, after)
    assert np.linalg.norm(there) == pytest.approx(np.sqrt(5.0), rel=1e-6)


def test_springs_of_a_pair_whose_contacts_have_changing_signs_go_with_the_nearest_corners():
    """Edges that pass each other, their end, and the corner there come in this order."""
    points, signs = np.array([[-1.0, -0.99], [0.98, -0.99], [1.0, -0.99]]), np.array([1.0, -1.0, 1.0])
    displacement = np.array([[0.1, 0.0], [0.2, 0.0], [0.3, 0.0]])
    springs = springs_at(replace(corners(points), sign=signs), displacement, 5.0 * signs, POSE)
    there = replace(corners(points[::-1]), sign=signs)
    np.testing.assert_allclose(carried_displacement(springs, there, POSE), displacement[::-1])


def test_springs_of_several_contacts_of_a_pair_go_with_the_nearest_corners():
    points = np.array([[-1.0, -0.99], [1.0, -0.99]])
    displacement = np.array([[0.1, 0.0], [0.2, 0.0]])
    springs = springs_at(corners(points), displacement, np.array([5.0, 5.0]), POSE)
    assert springs.energy == pytest.approx([0.025, 0.1])
    pose = Pose(POSE.position + [0.05, 0.0], POSE.orientation + 0.01)
    turn = rotation_matrices(np.array([[0.01]]))[0]
    moved = points @ turn.T + [0.05, 0.0]
    np.testing.assert_allclose(carried_displacement(springs, corners(moved), pose), displacement)
    np.testing.assert_allclose(carried_displacement(springs, corners(moved[::-1]), pose), displacement[::-1])
    np.testing.assert_allclose(carried_displacement(springs, corners(moved[1:]), pose), displacement[1:])
    new = np.vstack([moved, [[0.0, -0.99]]])
    np.testing.assert_allclose(carried_displacement(springs, corners(new), pose), np.vstack([displacement, [[0, 0]]]))


def test_springs_of_other_pairs_are_none():
    points = np.array([[-1.0, -0.99]])
    springs = springs_at(corners(points), np.array([[0.1, 0.0]]), np.array([5.0]), POSE)
    assert not carried_displacement(springs, corners(points, wall=3), POSE).any()
    assert not carried_displacement(springs, corners(points, body=1), POSE).any()
    assert carried_displacement(springs, select(corners(points), np.array([False])), POSE).shape == (0, 2)


def test_relaxed_springs_and_contacts_without_any_are_forgotten():
    points = np.array([[-1.0, -0.99], [0.0, -0.99], [1.0, -0.99]])
    displacement = np.array([[0.1, 0.0], [0.0, 0.0], [0.2, 0.0]])
    springs = springs_at(corners(points), displacement, np.array([5.0, 5.0, 0.0]), POSE)
    np.testing.assert_allclose(springs.displacement, displacement[:1])


def test_turning_goes_with_the_normal_and_its_twist_stays_along_it():
    random = np.random.default_rng(2)
    normals, turning = unit(random.normal(size=(2, 3))), random.normal(size=(1, 3))
    point, which, unknown = np.zeros((1, 3)), np.zeros(1, dtype=np.int64), np.full(1, np.nan)
    pose = Pose(np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0, 0.0]]))

    def contact(normal):
        return Contacts(which, which + 1, point, point, normal[None], unknown, unknown, unknown, which > -1, unknown)

    springs = springs_at(contact(normals[0]), np.zeros((1, 3)), np.ones(1), pose, turning)
    assert springs.energy == pytest.approx([0.5 * np.sum(turning**2)])
    displacement, there = carried_springs(springs, contact(normals[1]), pose)
    assert not displacement.any()
    assert there[0] @ normals[1] == pytest.approx(turning[0] @ normals[0])
    assert np.linalg.norm(there) == pytest.approx(np.linalg.norm(turning))
    assert not np.allclose(there, turning)
