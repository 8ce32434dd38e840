"""Volume and quality of simplices."""

import numpy as np
import pytest

from rigidfluid.core.mesh.mesh_quality import cell_quality, cell_volumes

REGULAR = {
    2: np.array([[0, 0], [1, 0], [0.5, np.sqrt(0.75)]]),
    3: np.array([[1.0, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]]),
}


def simplex(dimension):
    return np.arange(dimension + 1)[None]


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_unit_simplex_has_volume_one_over_factorial(dimension):
    points = np.vstack([np.zeros(dimension), np.eye(dimension)])
    assert cell_volumes(points, simplex(dimension)) == pytest.approx(1 / (2 if dimension == 2 else 6), rel=1e-15)


@pytest.mark.parametrize("dimension", [2, 3])
def test_volume_is_the_determinant_and_changes_sign_with_the_order(dimension):
    points = np.random.default_rng(1).normal(size=(40, dimension))
    cells = np.random.default_rng(2).permuted(np.tile(np.arange(40), (30, 1)), axis=1)[:, : dimension + 1]
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    expected = np.linalg.det(edges) / (2 if dimension == 2 else 6)
    np.testing.assert_allclose(cell_volumes(points, cells), expected, rtol=1e-12)
    swapped = cells[:, [1, 0, *range(2, dimension + 1)]]
    np.testing.assert_allclose(cell_volumes(points, swapped), -expected, rtol=1e-10)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_regular_simplex_of_any_size_has_quality_one(dimension):
    quality = [cell_quality(scale * REGULAR[dimension], simplex(dimension))[0] for scale in (1e-4, 1.0, 1e3)]
    orientation = np.sign(cell_volumes(REGULAR[dimension], simplex(dimension))[0])
    assert orientation == 1
    np.testing.assert_allclose(quality, 1.0, rtol=1e-14)


@pytest.mark.parametrize("dimension", [2, 3])
def test_flat_and_inverted_cells_have_quality_zero(dimension):
    flat = np.vstack([np.zeros(dimension), np.eye(dimension)[:-1], np.full(dimension, 0.5)])
    flat[-1, -1] = 0.0
    inverted = REGULAR[dimension][[1, 0, *range(2, dimension + 1)]]
    assert cell_quality(flat, simplex(dimension))[0] == 0.0
    assert cell_quality(inverted, simplex(dimension))[0] == 0.0


def test_a_right_isosceles_triangle_has_the_known_quality():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    assert cell_quality(points, simplex(2))[0] == pytest.approx(np.sqrt(3) / 2, rel=1e-14)
