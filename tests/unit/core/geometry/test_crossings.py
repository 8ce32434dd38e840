"""Facets that go through each other, and facets that are merely near."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.geometry.crossings import first_crossing

TRIANGLE = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
UPRIGHT = np.array([[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [0.9, 0.9, 0.5]])


def apart(*facets: object) -> tuple[FloatArray, np.ndarray]:
    """Points and vertices of facets that share none."""
    corners = np.array(facets, dtype=float)
    count, d, _ = corners.shape
    return corners.reshape(-1, d), np.arange(count * d).reshape(count, d)


@pytest.mark.parametrize(("moved", "cross"), [([0, 0, 0], True), ([0, 0, 0.6], False), ([0.5, 0.5, 0], False)])
def test_triangles_cross_where_an_edge_of_one_goes_through_the_other(moved: list[float], cross: bool) -> None:
    for pair in ([TRIANGLE, UPRIGHT + moved], [UPRIGHT + moved, TRIANGLE]):
        assert (first_crossing(*apart(*pair)) is not None) == cross


@pytest.mark.parametrize(("end", "cross"), [((1.0, 0.0), True), ((0.5, 0.5), True), ((0.4, 0.6), False)])
def test_edges_cross_or_touch_where_they_have_a_point_in_common(end: tuple[float, float], cross: bool) -> None:
    found = first_crossing(*apart([[0.0, 0.0], [1.0, 1.0]], [[0.0, 1.0], end]))
    assert (found is not None) == cross


def test_a_side_in_many_pieces_does_not_cross_itself() -> None:
    """By rounding, pieces of one straight line are on both sides of each other."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        corners, share = rng.uniform(0.0, 1.0, (3, 2)), np.arange(20)[:, None] / 20
        ahead = np.roll(corners, -1, axis=0)
        points = np.concatenate([a + share * (b - a) for a, b in zip(corners, ahead, strict=True)])
        numbers = np.arange(len(points))
        assert first_crossing(points, np.stack([numbers, np.roll(numbers, -1)], axis=1)) is None
