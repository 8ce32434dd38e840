"""Edges that pass each other in space, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.detectors.edge_pairs import passing_edges

ONE = np.array([[0, 1]])
ALONG = np.array([[-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]])


def test_an_edge_over_another_one_is_nearest_where_they_cross() -> None:
    """Aslant, at a height of .5, and above a quarter of the first one."""
    over = np.array([[-1.0, -2.0, 0.5], [0.5, 1.0, 0.5]])
    point_a, point_b, sign = passing_edges(ALONG, ONE, over, ONE, 0.6)
    np.testing.assert_allclose(point_a, [[0.0, 0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(point_b, [[0.0, 0.0, 0.5]], atol=1e-15)
    np.testing.assert_array_equal(sign, [1.0])
    assert len(passing_edges(ALONG, ONE, over, ONE, 0.4)[0]) == 0


@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("end", [0, 1])
def test_the_end_that_is_nearest_to_the_other_edge_is_taken_away(end: int, swapped: bool) -> None:
    """An end of the second one, .1 beyond the crossing and above a .2 from there along the first."""
    over = np.array([[-0.2, -0.1, 0.5], [4.0, 2.0, 0.5]])[:: 1 - 2 * end]
    pair = (over, ONE, ALONG, ONE) if swapped else (ALONG, ONE, over, ONE)
    first, second, sign = passing_edges(*pair, 0.6)
    point_a, point_b = (second, first) if swapped else (first, second)
    np.testing.assert_allclose(point_a, [[0.0, 0.0, 0.0], [-0.2, 0.0, 0.0]], atol=1e-15)
    np.testing.assert_allclose(point_b, [[0.0, 0.0, 0.5], [-0.2, -0.1, 0.5]], atol=1e-15)
    np.testing.assert_array_equal(sign, [1.0, -1.0])
    assert len(passing_edges(*pair, 0.505)[2]) == 1  # the end is .51 away


@pytest.mark.parametrize(
    "other",
    [
        [[0.0, 1.0, 0.5], [0.0, 2.0, 0.5]],
        [[0.0, -2.0, 0.5], [0.0, -1.0, 0.5]],
        [[-1.5, -1.0, 0.5], [-1.5, 1.0, 0.5]],
        [[3.5, -1.0, 0.5], [3.5, 1.0, 0.5]],
        [[-1.0, 0.0, 0.5], [3.0, 0.0, 0.5]],
    ],
    ids=["beyond its start", "beyond its end", "before the first", "behind the first", "parallel"],
)
def test_edges_that_are_nearest_at_an_end_do_not_pass(other: list[list[float]]) -> None:
    assert len(passing_edges(ALONG, ONE, np.array(other), ONE, 5.0)[0]) == 0
