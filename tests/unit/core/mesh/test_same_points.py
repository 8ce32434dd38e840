"""Points that return in another order, and changed by rounding, are found again; one that is lost is seen."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mesh.generation.same_points import rows_of

WITHIN = 1e-9


def lattice(dimension: int) -> FloatArray:
    """Points of which many share each coordinate, and some of a cloud."""
    axes = [np.linspace(0.0, 1.0, 6)] * dimension
    cloud = np.random.default_rng(0).random((50, dimension))
    return np.concatenate([np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, dimension), cloud])


@pytest.mark.parametrize("dimension", [2, 3])
def test_they_are_the_nearest(dimension: int) -> None:
    draw = np.random.default_rng(1)
    points = lattice(dimension)
    wanted = points[draw.permutation(len(points))[:60]] + draw.uniform(-1e-11, 1e-11, (60, dimension))
    np.testing.assert_array_equal(rows_of(wanted, points, WITHIN), cKDTree(points).query(wanted)[1])


def test_others_of_the_same_height_are_not_taken() -> None:
    here = np.zeros((1, 2))
    level = np.array([[np.sqrt(3.0), -np.sqrt(2.0)]])
    assert rows_of(here, np.concatenate([level, here, -level]), WITHIN) == [1]
    assert rows_of(here, level, WITHIN) is None


def test_one_that_is_lost_is_seen() -> None:
    points = lattice(2)
    assert rows_of(points, points[1:], WITHIN) is None
    assert rows_of(points + 2.0 * WITHIN, points, WITHIN) is None


def test_two_that_are_at_one_are_seen() -> None:
    points = lattice(2)
    assert rows_of(points[[3, 3]], points, WITHIN) is None


def test_of_several_that_near_the_nearest_is_taken() -> None:
    points = np.array([[0.0, 0.0], [0.3 * WITHIN, 0.0], [1.0, 0.0]])
    np.testing.assert_array_equal(rows_of(points[[1, 2, 0]], points, WITHIN), [1, 2, 0])


def test_none_are_found_where_none_are_wanted() -> None:
    found = rows_of(np.empty((0, 3)), lattice(3), WITHIN)
    assert found is not None
    assert len(found) == 0
