"""Ticks, levels and the end of time."""

import pytest

from rigidfluid.core.run.clock import Clock


def test_a_step_stays_on_its_grid_grows_twofold_and_does_not_pass_the_end():
    clock = Clock.for_steps(0.1, 0.1 / 8, 0.35)
    assert clock.levels == 3
    assert clock.longest_level(0, None) == 0
    assert clock.longest_level(4, 1) == 1  # half-way along the nominal grid
    assert clock.longest_level(8, 3) == 2  # at most twice the last
    assert clock.longest_level(24, 0) == 1  # the end is at 28


@pytest.mark.parametrize("step", [0.001, 0.004, 0.1, 0.3, 0.7])
def test_halvings_are_counted_exactly(step):
    assert [Clock.for_steps(step, step / 2**k, 1.0).levels for k in range(30)] == list(range(30))
    assert Clock.for_steps(0.3, 0.1, 1.0).levels == 1


def test_a_time_between_two_ticks_has_one_on_either_side():
    clock = Clock.for_steps(0.1, 0.1 / 8, 1.0)
    assert (clock.tick_until(0.03), clock.tick_from(0.03)) == (2, 3)
    assert (clock.tick_until(0.3), clock.tick_from(0.3)) == (24, 24)


def test_the_end_leaves_no_sliver_of_a_step():
    clock = Clock.for_steps(0.1, 0.1 / 1024, 0.3537)
    assert clock.time(clock.last_tick) == pytest.approx(0.3625)
    assert Clock.for_steps(0.004, 0.004 / 1024, 1.0).last_tick == 250 * 1024
