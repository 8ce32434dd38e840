"""Distances to bodies that have turned."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mesh_tools import ball, upright

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.frames import distance_to_body
from rigidfluid.core.mechanics.rigid import rotation_matrices

TURNED: dict[int, FloatArray] = {2: np.array([[0.7]]), 3: np.array([[0.5, 0.1, 0.7, 0.5]])}


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_distance_of_a_ball_is_the_same_to_the_last_bit_however_it_has_turned(dimension: int) -> None:
    points = np.random.default_rng(0).normal(size=(50, dimension))
    still = upright(np.full(dimension, 0.3))
    turned = replace(still, orientation=TURNED[dimension] / np.linalg.norm(TURNED[dimension]) ** (dimension - 2))
    assert np.abs(rotation_matrices(turned.orientation) - rotation_matrices(still.orientation)).max() > 0.1
    found = [distance_to_body(pose, 0, ball(0.2, dimension), points) for pose in (still, turned)]
    np.testing.assert_array_equal(*found)
    np.testing.assert_allclose(found[0], np.linalg.norm(points - 0.3, axis=1) - 0.2)
