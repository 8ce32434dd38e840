"""Cell lists find what all pairs find."""

import numpy as np
import pytest

from rigidfluid.core.contact.pairs.broad_phase import near_pairs
from rigidfluid.core.contact.pairs.cell_list import near_each_ball

EXTENTS = {"plane": (9.0, 9.0), "cube": (4.0, 4.0, 4.0), "line": (60.0, 0.0), "pile": (1e-9, 1e-9, 1e-9)}


def naive(position, radii, planes, reach):
    pairs = list(zip(*map(np.ndarray.tolist, near_pairs(position, radii, reach)), strict=True))
    for wall, (point, normal) in enumerate(planes):
        near = np.flatnonzero((position - point) @ normal - radii <= reach)
        pairs += [(int(ball), len(radii) + wall) for ball in near]
    return sorted(pairs)


@pytest.mark.parametrize("extent", EXTENTS.values(), ids=EXTENTS)
@pytest.mark.parametrize("reach", [0.0, 0.3, np.inf])
def test_the_list_is_that_of_all_pairs(extent, reach):
    random, d = np.random.default_rng(3), len(extent)
    position = random.uniform(0.0, 1.0, (120, d)) * extent
    radii = random.uniform(0.02, 0.4, 120)
    planes = np.array([[np.zeros(d), np.eye(d)[0]], [np.array(extent), -np.eye(d)[1]]])
    start, second = near_each_ball(position, radii, planes, reach)
    first = np.repeat(np.arange(120), np.diff(start))
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == naive(position, radii, planes, reach)


def test_equal_balls_are_found_across_whole_cells():
    """Many of their pairs are as long as a cell is wide."""
    position, radii = np.random.default_rng(5).uniform(0.0, 3.9, (150, 2)), np.full(150, 0.5)
    start, second = near_each_ball(position, radii, np.empty((0, 2, 2)), 0.0)
    first = np.repeat(np.arange(150), np.diff(start))
    assert list(zip(first.tolist(), second.tolist(), strict=True)) == naive(position, radii, [], 0.0)


def test_a_list_grows_as_far_as_it_must():
    start, second = near_each_ball(np.zeros((90, 3)), np.ones(90), np.empty((0, 2, 3)), 0.1)
    assert start[-1] == len(second) == 90 * 89 // 2


@pytest.mark.parametrize("odd", [np.nan, np.inf, 1e100])
def test_a_ball_that_is_nowhere_has_no_neighbours(odd):
    position = np.array([[0.0, 0.0], [1.5, 0.0], [odd, 0.0]])
    with np.errstate(all="ignore"):  # as in compiled code
        start, second = near_each_ball(position, np.ones(3), np.empty((0, 2, 2)), 0.1)
    assert second.tolist() == [1]
    assert start.tolist() == [0, 1, 1, 1]


def test_hundreds_of_thousands_of_tiny_balls_are_in_cells_too():
    """Along each axis there might be millions of cells."""
    position = np.random.default_rng(1).random((300_000, 3))
    position[1] = position[0]
    start, second = near_each_ball(position, np.full(300_000, 1e-8), np.empty((0, 2, 3)), 1e-8)
    assert start[1] == 1
    assert second.tolist() == [1]
