"""Figures of a suspension that no run of balls without friction tells apart."""

from __future__ import annotations

import numpy as np

from rigidfluid.core.mechanics.suspension import contact_stress, symmetric, touching_pairs


def test_the_stress_of_contacts_has_the_force_in_its_rows_and_the_arm_in_its_columns() -> None:
    """A force along x between bodies that are apart along y, as by friction."""
    found = contact_stress(np.array([[3.0, 0.0]]), np.array([[0.0, 2.0]]), 4.0)
    np.testing.assert_allclose(found, [[0.0, -1.5], [0.0, 0.0]])


def test_bodies_that_touch_twice_are_one_pair() -> None:
    a, b = np.array([2, 0, 2, 1, -1]), np.array([0, 2, 1, -1, 1])
    np.testing.assert_array_equal(touching_pairs(a, b), [[0, 2], [1, 2]])


def test_a_stress_is_its_symmetric_part_and_one_that_turns() -> None:
    np.testing.assert_allclose(symmetric(np.array([[1.0, 4.0], [0.0, 3.0]])), [[1.0, 2.0], [2.0, 3.0]])
