"""Energy that came from nowhere or vanished, whatever else flows through."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from made_up_energy import table, warned

from rigidfluid.core.output.energy_account import energy_account
from rigidfluid.core.output.energy_flows import largest_growth
from rigidfluid.errors import OutputError

ERROR = 0.3


def shares(energy):
    """What came from nowhere, and what vanished, over what was at hand."""
    account = energy_account(energy)
    return account.share(account.creation.largest), account.share(account.loss.largest)


def through(lengths, **columns):
    """A flow with a kinetic energy of 10 in which .5 enters and is dissipated in each step, so many times 50 steps."""
    states = 50 * lengths + 1
    passed = 0.5 * np.arange(states)
    return table(states, boundary=passed, dissipation=passed, **columns)


def step_at(state, states, change):
    return 10.0 + change * (np.arange(states) >= state)


def test_a_loss_hides_no_creation_after_it():
    energy = table(kinetic=[10, 10, 9.2, 9.2, 9.6, 9.6])
    assert shares(energy) == pytest.approx((0.04, 0.08))
    came, vanished = warned(energy)
    assert "4 % of the energy at hand came from nowhere between 0.3 and 0.4" in came.text
    assert "8 % of the energy at hand vanished between 0.1 and 0.2" in vanished.text


def test_all_rises_and_falls_are_summed_by_cause():
    parts = {"residual_contacts": [0, 0.1, 0.1, 0.3, 0.3, 0.3], "residual_start": [0, 0, 0, 0, -0.5, -0.5]}
    account = energy_account(table(kinetic=[10, 9.9, 9.8, 9.6, 10.1, 10.0], **parts))
    loss, creation = account.loss, account.creation
    assert {name: value for name, value in loss.by_cause.items() if value} == pytest.approx(
        {"residual_contacts": 0.3, "residual_steps": 0.2}
    )
    assert {name: value for name, value in creation.by_cause.items() if value} == pytest.approx({"residual_start": 0.5})
    assert (loss.summed, creation.summed) == pytest.approx((0.5, 0.5))
    assert loss.largest == pytest.approx(0.4)


@pytest.mark.parametrize(("change", "sums"), [(-0.3, (0.0, 0.1)), (0.3, (0.3, 0.0))])
def test_friction_of_impacts_is_taken_off_the_sum_of_losses_alone(change, sums):
    friction = 0.2 * (np.arange(6) > 2)
    account = energy_account(table(kinetic=step_at(3, 6, change), path_friction=friction))
    assert (account.creation.summed, account.loss.summed) == pytest.approx(sums)


@pytest.mark.parametrize("state", [1, 25, 50])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_what_flows_through_does_not_make_an_error_small(state, sign):
    """The same error in runs of one, two and four lengths, at their start, in their midst or late."""
    for lengths in (1, 2, 4):
        energy = through(lengths, kinetic=step_at(state, 50 * lengths + 1, sign * ERROR))
        assert max(shares(energy)) == pytest.approx(0.03)
        assert len(warned(energy)) == 1


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_an_error_at_a_constant_rate_is_the_same_however_long_the_run_is(sign):
    """A hundredth of what is dissipated, of which as much as was at hand is one stretch."""
    for lengths in (1, 2, 4):
        energy = through(lengths)
        energy["residual"] = energy["residual_steps"] = sign * 0.01 * energy["dissipation"]
        assert max(shares(energy)) == pytest.approx(0.01, rel=1e-6)


@pytest.mark.parametrize("way", ["contact", "control", "body_force", "gravity", "exchange"])
def test_a_loss_is_told_where_nothing_was_put_in(way):
    """Bodies attract each other at the start; work that only takes."""
    taken = {"contact": [-1.0] * 6} if way == "contact" else {way: -0.2 * np.arange(6)}
    moved = np.array([0.0, 0.3, 0.5, 0.4, 0.2, 0.1])
    energy = table(kinetic=moved, **taken)
    energy["residual"] = energy["residual_steps"] = 0.135 * (np.arange(6) > 2)
    assert energy_account(energy).put_in <= 0.0
    assert shares(energy)[1] > 0.1
    assert any("vanished" in warning.text and warning.serious for warning in warned(energy))


def test_all_that_came_in_and_vanished_is_told():
    assert shares(table(kinetic=np.zeros(6), body_force=0.1 * np.arange(6))) == (0.0, 1.0)


def test_bodies_at_rest_keep_their_energy():
    energy = table(kinetic=np.zeros(6), contact=np.full(6, 3.0))
    assert shares(energy) == (0.0, 0.0)
    assert shares(table(kinetic=np.zeros(6))) == (0.0, 0.0)


def test_round_off_adds_up_to_nothing():
    """A residual that swings by the last digits of what flows through, for a long time."""
    states = 20001
    energy = through(400)
    energy["residual"] = energy["residual_steps"] = 8e4 * np.finfo(float).eps * (np.arange(states) % 2)
    account = energy_account(energy)
    assert 1e-16 < account.round_off / energy["boundary"][-1] < 1e-14
    assert account.loss.summed == account.creation.summed == account.loss.largest == 0.0


def test_a_swing_that_comes_back_is_no_creation_but_is_summed():
    """As the energy of a spring by a reversible scheme."""
    account = energy_account(table(201, kinetic=10.0 + 0.05 * (np.arange(201) % 2)))
    assert account.creation.largest == pytest.approx(0.05)
    assert account.creation.summed == pytest.approx(100 * 0.05)
    assert warned(table(201, kinetic=10.0 + 0.05 * (np.arange(201) % 2))) == []


@pytest.mark.parametrize(("states", "stretch"), [(6, 10.0), (50, 20.0), (500, 20.0)])
def test_a_creeping_flow_is_judged_by_ten_steps(states, stretch):
    """Nothing is stored: a step that is a third off is no third of anything that lasts."""
    passed = 2.0 * np.arange(states)
    energy = table(states, kinetic=np.zeros(states), boundary=passed + 0.6 * (passed > 4), dissipation=passed)
    assert shares(energy)[1] == pytest.approx(0.6 / stretch)


def test_the_largest_growth_is_that_of_all_pairs():
    generator = np.random.default_rng(5)
    for stretch in (0.0, 0.7, 3.0, 40.0):
        clock = np.cumsum(generator.integers(0, 3, 40) * 0.5)
        balance = generator.normal(size=40)
        pairs = [
            (balance[j] - balance[i], i, j) for i, j in combinations(range(40), 2) if clock[j] - clock[i] <= stretch
        ]
        assert largest_growth(balance, clock, stretch) == max(pairs)


def test_what_is_at_hand():
    """Thrown up with 1 by a spring that holds 2, and falling on beyond the start through a thick fluid."""
    thrown = table(
        kinetic=[1, 0, 0, 1, 1, 0.5],
        contact=[2, 2, 0, 0, 0, 0],
        gravity=[0, -1, -3, -1, -0.5, -0.5],
        dissipation=[0, 0, 0, 1, 1.5, 2],
    )
    assert np.abs(thrown["residual"]).max() == 0.0
    assert energy_account(thrown).at_hand == 1.0 + 2.0
    assert energy_account(table(kinetic=np.ones(6), contact=np.full(6, 3.0))).at_hand == 1.0 + 3.0
    attracted = table(kinetic=[0, 1, 2, 3, 4, 5], contact=[-1, -2, -3, -4, -5, -6])
    assert energy_account(attracted).at_hand == 5.0


@pytest.mark.parametrize("way", ["gravity", "boundary", "control", "body_force", "exchange"])
def test_a_longer_way_does_not_make_an_error_small(way):
    """A steady fall, or drive, in which the same energy vanishes once."""
    for lengths in (1, 2, 4):
        passed = 0.5 * np.arange(50 * lengths + 1)
        lost = ERROR * (passed > 5.0)
        energy = table(len(passed), **{way: passed}, dissipation=passed - lost)
        assert shares(energy) == pytest.approx((0.0, 0.03))


def test_a_burst_of_dissipation_is_as_much_as_it_is():
    """It took 20 at once, as from a jump of a face: what comes from nowhere later is told against no more."""
    for states in (20, 200):
        burst = 20.0 * (np.arange(states) > 0)
        energy = table(states, kinetic=1.0 + 0.5 * (np.arange(states) > 15), boundary=burst, dissipation=burst)
        assert energy_account(energy).at_hand == 20.0
        assert shares(energy)[0] == pytest.approx(0.5 / 20.0)


@pytest.mark.parametrize("column", ["kinetic", "residual_start", "path_friction"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_table_with_gaps_is_named(column, value):
    energy = table()
    energy[column][3] = value
    with pytest.raises(OutputError, match=rf"energy.csv, {column}: found {value} at the time 0.3; allowed is finite"):
        energy_account(energy)


@pytest.mark.parametrize("taker", ["dissipation", "grad_div_loss", "contact_loss"])
def test_a_step_may_take_more_than_is_there(taker):
    energy = table(3, kinetic=np.ones(3), control=[0, 4, 6], **{taker: [0, 4, 6]})
    assert energy_account(energy).at_hand == 6.0
