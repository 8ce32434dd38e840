"""Fields of a mesh that is cut open anywhere are continued into the whole domain."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.lattice import Lattice
from rigidfluid.core.model.types import Fields
from rigidfluid.core.output.field_images import continued

DROP = np.array([3.0, -2.0])
"""Of the pressure along each period."""


def exact(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A velocity of period 2 along x and 1 along y, and a pressure that falls along both."""
    x, y = points.T
    velocity = np.stack([np.sin(np.pi * x) * np.cos(2.0 * np.pi * y), np.cos(np.pi * x)], axis=1)
    return velocity, np.sin(2.0 * np.pi * y) - DROP[0] * x / 2.0 - DROP[1] * y


def torn(vectors: FloatArray) -> Fields:
    """The rectangle of 2 by 1 in triangles of six nodes, each third of them displaced by periods, some by two."""
    nx, ny = 6, 4
    corner = np.array([(i, j) for i in range(nx) for j in range(ny)])
    square = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]])
    triangles = (corner[:, None, None] + square).reshape(-1, 3, 2)
    six = np.concatenate([triangles, 0.5 * (triangles + np.roll(triangles, -1, axis=1))], axis=1)
    random = np.random.default_rng(4)
    points = six * [2.0 / nx, 1.0 / ny]
    for vector in vectors:
        points = points + random.integers(-1, 3, len(points))[:, None, None] * vector
    kept, cells = np.unique(np.round(points.reshape(-1, 2), 9), axis=0, return_inverse=True)
    return Fields(kept, cells.reshape(-1, 6), *exact(kept), scalar=exact(kept)[0][:, 0])


@pytest.mark.parametrize("count", [1, 2])
def test_the_domain_is_covered_once_with_what_is_there(count: int) -> None:
    vectors = np.array([[2.0, 0.0], [0.0, 1.0]])[:count]
    fields = torn(vectors)
    assert np.ptp(fields.points[:, 0]) > 4.0
    found = continued(fields, Lattice(vectors, np.zeros(2)))
    corners = found.points[found.cells[:, :3]]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = 0.5 * np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])
    assert area.sum() == pytest.approx(2.0)
    assert found.points.min() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(found.points.max(axis=0), [2.0, 1.0])
    velocity, pressure = exact(found.points)
    np.testing.assert_allclose(found.velocity, velocity, atol=1e-7)
    np.testing.assert_allclose(found.pressure, pressure, atol=1e-7)
    np.testing.assert_allclose(found.scalar, velocity[:, 0], atol=1e-7)


def test_cells_across_the_surface_are_at_both_ends() -> None:
    vectors = np.array([[2.0, 0.0]])
    half = torn(np.zeros((0, 2)))
    points = half.points + [0.1, 0.0]
    found = continued(Fields(points, half.cells, *exact(points)), Lattice(vectors, np.zeros(2)))
    assert found.points[:, 0].min() == pytest.approx(0.1 - 2.0 / 6.0)
    assert found.points[:, 0].max() == pytest.approx(2.1)
    np.testing.assert_allclose(found.pressure, exact(found.points)[1], atol=1e-9)


def test_without_periods_fields_are_as_they_are() -> None:
    fields = torn(np.zeros((0, 2)))
    assert continued(fields, Lattice(np.zeros((0, 2)), np.zeros(2))) is fields
