"""Neighbour lists: how often pairs are searched for."""

import numpy as np

from rigidfluid.core.contact.pairs.near_pairs import NearPairs

NO_WALLS = np.empty((0, 2, 2))


def moving_balls(count):
    position = np.random.default_rng(0).uniform(0.0, count**0.5, (count, 2))
    return position, position + 5.0


def test_all_pairs_of_few_balls_are_listed_once():
    near, (here, there) = NearPairs(np.full(5, 0.1), NO_WALLS), moving_balls(5)
    listed = near.within(here, 0.1)
    assert len(listed.second) == 10
    assert near.within(there, 0.2) is listed


def test_pairs_of_many_balls_are_listed_again_where_balls_have_moved():
    near, (here, there) = NearPairs(np.full(60, 0.1), NO_WALLS), moving_balls(60)
    listed = near.within(here, 0.1)
    assert near.within(here + 1e-3, 0.1) is listed
    assert near.within(there, 0.1) is not listed


def test_a_list_that_looks_much_too_far_is_not_taken():
    near, (here, _) = NearPairs(np.full(60, 0.1), NO_WALLS), moving_balls(60)
    listed = near.within(here, 1.0)
    assert near.within(here, 0.1) is not listed
