"""Steps about impacts that they do not resolve: shorter ones in them, longer ones again as the fluid calms down."""

from __future__ import annotations

from dataclasses import replace

import fluid_contacts as scenes
import numpy as np
import pytest

from rigidfluid.core.contact.path.body_step import BodyStep
from rigidfluid.core.coupling.stirring import FELT, STORED, impact_tick
from rigidfluid.core.mechanics.wrenches import nothing
from rigidfluid.core.model.energy import Ledger
from rigidfluid.core.model.state import ErrorEstimate, State
from rigidfluid.core.run.impacts import (
    MOST_CLOSE_HALVINGS,
    MOST_HALVINGS,
    TOLERATED_CREATION,
    TOLERATED_FRICTION,
    is_unresolved,
    level_after_impact,
)
from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

STEP = 4e-3
PUT_IN = 2.0


@pytest.fixture(scope="module")
def run() -> Simulation:
    """Until after the first impact of a thrown disk, and a while longer."""
    simulation = Simulation(scenes.bounce(STEP))
    simulation.go(0.02)
    return simulation


@pytest.fixture
def state(run: Simulation) -> State:
    ledger = Ledger(kinetic=1.0, contact=0.0, initial=0.5 * PUT_IN, gravity=0.5 * PUT_IN, boundary=-3.0)
    return replace(run.state, ledger=ledger)


def path(state: State, friction: float, drag_left_out: float = 0.0) -> BodyStep:
    none = nothing(state.pose)
    return BodyStep(state.pose, state.twist, state.motions, none, 0.0, 0.0, 1, state.link, friction, drag_left_out)


def test_what_comes_in_counts_as_put_in_and_what_goes_out_does_not(state):
    assert state.ledger.put_in == PUT_IN


def test_an_impact_that_takes_too_much_halves_the_step_a_few_times(state):
    too_much, enough = path(state, 1.01 * TOLERATED_FRICTION * PUT_IN), path(state, 0.99 * TOLERATED_FRICTION * PUT_IN)
    halved = [is_unresolved(state, too_much, level) for level in range(MOST_HALVINGS + 1)]
    assert halved == [True] * MOST_HALVINGS + [False]
    assert not is_unresolved(state, enough, 0)


@pytest.mark.parametrize(
    ("created", "in_contacts", "friction", "left_out", "halvings"),
    [
        (1.01, 1.01, 0.0, 1.01, MOST_CLOSE_HALVINGS),
        (0.99, 1.01, 0.0, 1.01, 0),
        (1.01, 0.99, 0.0, 1.01, 0),
        (1.01, 1.01, 0.0, 0.99, 0),
        (1.01, 1.01, 0.2, 1.01, 0),
        (1.01, 1.01, 1.01, 2.0, MOST_HALVINGS),
    ],
)
def test_contacts_that_turn_velocities_smoothly_halve_steps_once_they_have_created_energy(
    state: State, created: float, in_contacts: float, friction: float, left_out: float, halvings: int
) -> None:
    """All in parts of what is tolerated."""
    tolerated, balanced = TOLERATED_CREATION * PUT_IN, state.ledger.kinetic + state.ledger.residual
    energies = {"kinetic": balanced + created * tolerated, "residual_contacts": -in_contacts * tolerated}
    state = replace(state, ledger=replace(state.ledger, **energies))
    turned = path(state, friction * TOLERATED_FRICTION * PUT_IN, left_out * TOLERATED_FRICTION * PUT_IN)
    found = [is_unresolved(state, turned, level) for level in range(MOST_CLOSE_HALVINGS + 2)]
    assert found == [True] * halvings + [False] * (MOST_CLOSE_HALVINGS + 2 - halvings)


def test_halvings_count_from_the_level_that_a_tolerance_asked_for(state):
    shorter = replace(state, estimate=ErrorEstimate(9, 2, 0.0, 0.0, 1.0, 1.0))
    too_much = path(state, 1.01 * TOLERATED_FRICTION * PUT_IN)
    found = [is_unresolved(shorter, too_much, level) for level in range(MOST_HALVINGS + 3)]
    assert found == [True] * (MOST_HALVINGS + 2) + [False]


@pytest.mark.parametrize(
    ("friction", "stored", "found"), [(1.1 * FELT, 0.0, 99), (0.9 * FELT, 0.9 * STORED, 7), (0.0, -1.1 * STORED, 99)]
)
def test_an_impact_is_remembered_where_friction_or_a_contact_took_much(state, friction, stored, found):
    before = replace(state, impact=7)
    after = replace(state, tick=99, ledger=replace(state.ledger, contact=stored * PUT_IN))
    assert impact_tick(before, path(state, friction * PUT_IN), after) == found


def test_steps_grow_no_faster_than_the_impact_ages(run, state):
    clock, lately = run.clock, replace(state, level=3)

    def level(age: int) -> int:
        """Some steps of level 3 after the impact."""
        return level_after_impact(replace(lately, impact=state.tick - age * clock.ticks(3)), clock, 0)

    assert [level(age) for age in (0, 1, 4, 7, 8, 15, 16, 31, 32)] == [3, 3, 3, 3, 2, 2, 1, 1, 0]
    assert level_after_impact(replace(lately, impact=None), clock, 0) == 0


def test_a_run_goes_through_an_impact_by_short_steps(run):
    times = run.history.energy["time"]
    sizes, speed = np.diff(times), run.history.bodies["vy"]
    hit = int(np.flatnonzero((speed[:-1] < 0.0) & (speed[1:] > 0.0))[0])
    assert sizes[hit] == pytest.approx(STEP / 16.0)
    assert sizes[-1] == pytest.approx(STEP / 2.0)
