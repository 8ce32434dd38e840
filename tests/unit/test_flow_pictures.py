"""What pictures of a flow show: vorticity and grid values of known fields, in triangles and tetrahedra."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rigidfluid.core.model.types import Fields, FloatArray
from rigidfluid.reports.flow import EDGES, vorticity
from rigidfluid.reports.raster import Grid, Sampling

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
CORNERS = np.vstack([np.zeros(3), np.eye(3)])


def quadratic(corners: FloatArray, cells: np.ndarray, bulge: float = 0.0) -> tuple[FloatArray, np.ndarray]:
    """Nodes and cells with middles of edges, which are moved by ``bulge``; nodes are not shared."""
    points = corners[cells]
    first, second = np.transpose(EDGES[cells.shape[1]])
    middles = 0.5 * (points[:, first] + points[:, second])
    middles = middles + bulge * np.sin(7.0 * middles)
    nodes = np.concatenate([points, middles], axis=1)
    count = nodes.shape[1]
    return nodes.reshape(-1, corners.shape[1]), np.arange(len(cells) * count).reshape(-1, count)


def fields(points: FloatArray, cells: np.ndarray, velocity: FloatArray) -> Fields:
    return Fields(points, cells, velocity, np.zeros(len(points)))


@pytest.mark.parametrize("bulge", [0.0, 0.03])
def test_a_rigid_rotation_has_twice_its_rate_as_vorticity_in_curved_cells_too(bulge: float) -> None:
    points, cells = quadratic(SQUARE, TRIANGLES, bulge)
    turning = 3.0 * np.column_stack([-points[:, 1], points[:, 0]])
    np.testing.assert_allclose(vorticity(fields(points, cells, turning)), 6.0, rtol=1e-12)


def test_the_vorticity_of_a_parabola_is_its_slope() -> None:
    points, cells = quadratic(SQUARE, TRIANGLES)
    y = points[:, 1]
    flow = fields(points, cells, np.column_stack([y * (1.0 - y), np.zeros_like(y)]))
    np.testing.assert_allclose(vorticity(flow), (2.0 * y - 1.0)[cells], atol=1e-12)


@given(st.tuples(*3 * [st.floats(-2.0, 2.0)]))
@settings(max_examples=20, deadline=None)
def test_in_3d_the_component_along_the_normal(rate: tuple[float, float, float]) -> None:
    points, cells = quadratic(CORNERS, np.array([[0, 1, 2, 3]]))
    flow = fields(points, cells, np.cross(rate, points))
    for normal in np.eye(3):
        np.testing.assert_allclose(vorticity(flow, normal), 2.0 * normal @ rate, atol=1e-12)


@pytest.mark.parametrize("bulge", [0.0, 0.03])
def test_a_grid_has_the_values_of_a_linear_field_and_none_outside(bulge: float) -> None:
    points, cells = quadratic(SQUARE, TRIANGLES, bulge)
    grid = Grid.between(np.array([-0.5, -0.5]), np.array([1.5, 1.5]), 40)
    sampling = Sampling.of(fields(points, cells, points), grid)
    x, y = (sampling.image(points[:, k][cells]) for k in range(2))
    i, j = np.meshgrid(np.arange(grid.columns), np.arange(grid.rows))
    known = np.isfinite(x)
    assert known.mean() == pytest.approx(0.25, abs=0.03)
    error = np.hypot(x - grid.origin[0] - i * grid.right[0], y - grid.origin[1] - j * grid.up[1])
    assert np.nanmax(error) < (1e-12 if bulge == 0.0 else 0.02)


def test_a_slice_of_a_tetrahedron() -> None:
    points, cells = quadratic(CORNERS, np.array([[0, 1, 2, 3]]))
    grid = Grid(np.array([0.0, 0.0, 0.25]), np.array([0.01, 0.0, 0.0]), np.array([0.0, 0.01, 0.0]), 101, 101)
    image = Sampling.of(fields(points, cells, points), grid).image((points @ (1.0, 2.0, 4.0))[cells])
    i, j = np.meshgrid(np.arange(101), np.arange(101))
    inside = i + j <= 75
    np.testing.assert_allclose(image[inside], (0.01 * i + 0.02 * j + 1.0)[inside], atol=1e-12)
    assert np.isnan(image[~inside]).all()
