"""Implicit steps with springs along surfaces: what rests, what slides, and what springs give back."""

from dataclasses import replace

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from ended_runs import run_to_end
from slopes import FRICTION, GRAVITY, RADIUS, RANGE, STICKING, block_on_slope, sliding_ball

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.contact.path.implicit_friction import Slip, contacts_of_mean_force, rubbing
from rigidfluid.core.model.signed_law import SignedLaw
from rigidfluid.core.model.types import Contacts, Motion
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.forces.spring_dashpot import SpringDashpotLaw, SpringDashpotOptions

IMPLICIT = STICKING | {"stepping": "implicit"}


def disk_on_slope(steepness, end, step):
    """A disk that must not turn, on a slope of friction times ``steepness``; at first it presses with its weight."""
    angle = np.arctan(steepness * FRICTION)
    weight = np.pi * RADIUS**2 * GRAVITY * np.cos(angle)
    disk = ball([0.5, RADIUS + RANGE - weight / STICKING["stiffness"]], [0.0, 0.0], free=["x", "y"])
    gravity = [GRAVITY * np.sin(angle), -GRAVITY * np.cos(angle)]
    return dry_scene(IMPLICIT, disk, end=end, step=step, gravity=gravity, upper=[3.0, 1.0])


def assert_keeps_its_account(state):
    ledger = state.ledger
    assert abs(ledger.residual) < 1e-6 * max(abs(ledger.gravity), ledger.initial)
    assert ledger.contact_loss > 0.0


def assert_rests(state, steepness, mass):
    assert np.linalg.norm(state.twist.velocity) < 1e-4
    shear = np.sum(state.springs.stiffness[:, None] * state.springs.displacement, axis=0)
    assert shear == pytest.approx([mass * GRAVITY * np.sin(np.arctan(steepness * FRICTION)), 0.0], rel=1e-3)


def assert_slides(middle, end, steepness, time):
    angle = np.arctan(steepness * FRICTION)
    acceleration = GRAVITY * (np.sin(angle) - FRICTION * np.cos(angle))
    gained = end.twist.velocity[0, 0] - middle.twist.velocity[0, 0]
    assert gained == pytest.approx(time * acceleration, rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize("step", [4e-3, pytest.param(5e-4, marks=pytest.mark.nightly)])
def test_friction_holds_a_disk_just_below_its_angle(step):
    """It starts with relaxed springs, and slips until the excess of friction over its weight has stopped it."""
    state = run_to_end(disk_on_slope(0.99, 2.6, step))
    assert_rests(state, 0.99, np.pi * RADIUS**2)
    assert_keeps_its_account(state)


@pytest.mark.parametrize("step", [4e-3, pytest.param(5e-4, marks=[pytest.mark.long, pytest.mark.nightly])])
def test_a_disk_slides_just_above_that_angle(step):
    middle, end = (run_to_end(disk_on_slope(1.01, time, step)) for time in (0.5, 1.0))
    assert_slides(middle, end, 1.01, 0.5)
    assert_keeps_its_account(end)


def test_friction_holds_a_block_in_two_contacts():
    state = run_to_end(block_on_slope(0.9, end=0.8, step=8e-3, stepping="implicit"))
    assert len(state.springs) == 2
    assert_rests(state, 0.9, 0.04)
    assert_keeps_its_account(state)


@pytest.mark.long
@pytest.mark.nightly
def test_a_block_rests_and_slides_at_one_percent_from_the_angle():
    rests = run_to_end(block_on_slope(0.99, end=2.6, step=4e-3, stepping="implicit"))
    assert_rests(rests, 0.99, 0.04)
    middle, end = (run_to_end(block_on_slope(1.01, end=time, step=4e-3, stepping="implicit")) for time in (0.5, 1.0))
    assert_slides(middle, end, 1.01, 0.5)
    for state in (rests, end):
        assert_keeps_its_account(state)


@pytest.mark.parametrize("step", [2e-2, 4e-3])
def test_a_sliding_ball_ends_in_rolling(step):
    state, resolved = run_to_end(sliding_ball(0.2, step, stepping="implicit")), run_to_end(sliding_ball(0.2, 4e-3))
    np.testing.assert_allclose(state.twist.velocity[0, 0], resolved.twist.velocity[0, 0], rtol=2e-3)
    np.testing.assert_allclose(state.twist.angular_velocity[0, 1], resolved.twist.angular_velocity[0, 1], rtol=5e-3)
    assert_keeps_its_account(state)


@pytest.mark.parametrize("friction", [0.3, 50.0])
@pytest.mark.parametrize("restitution", [0.1, 1.0])
@pytest.mark.parametrize("stiffness", [26.7, 4e4])
@pytest.mark.parametrize("step", [2e-2, pytest.param(4e-3, marks=pytest.mark.long)])
def test_a_rebound_gives_no_energy_whatever_the_step_resolves(step, stiffness, restitution, friction):
    """The spring has k/k_t = 1.5 and .001, and an impact takes 5 and 25 steps."""
    keys = {"tangential_stiffness": stiffness, "restitution": restitution, "friction": friction}

    def scene(contact, step):
        return dry_scene(contact | keys, ball([0.5, 0.2], [0.1, -0.2]), end=1.0, step=step)

    state, resolved = run_to_end(scene(IMPLICIT, step)), run_to_end(scene(STICKING, 4e-3))
    assert state.springs is None
    assert_keeps_its_account(state)
    assert state.ledger.kinetic < state.ledger.initial
    if friction * stiffness < 1e6:  # else the spring swings thousands of times, and its phase is anyone's
        np.testing.assert_allclose(state.twist.velocity, resolved.twist.velocity, atol=0.02 if step > 4e-3 else 0.002)


def test_no_step_of_a_heap_with_stiff_springs_fails():
    """Springs of a thousand times the stiffness across: tangents alone would change between stick and slip for ever."""
    places = [[0.16 + 0.25 * i + 0.01 * ((3 * i + j) % 4), 0.15 + 0.24 * j] for i in range(4) for j in range(3)]
    contact = IMPLICIT | {"restitution": 0.3, "stiffness": 400.0, "tangential_stiffness": 3e5}
    scene = dry_scene(
        contact,
        *(ball(place, [0.0, 0.0]) for place in places),
        end=0.28,
        step=4e-3,
        gravity=[2.0, -10.0],
        upper=[1.2] * 2,
    )
    state = run_to_end(scene)
    assert state.count == 70
    assert len(state.springs) >= 4
    assert_keeps_its_account(state)


def test_walls_without_springs_keep_their_friction_beside_pairs_with_springs():
    """The second disk is far away."""
    disk, other = ball([0.5, RADIUS + RANGE - 8e-4], [1.0, 0.0]), ball([2.5, 0.5], [0.0, 0.0])
    walls = {key: STICKING[key] for key in STICKING if key != "tangential_stiffness"} | {"stiffness": 400.0}
    data = dry_scene({}, disk, other, end=0.06, step=2e-3, gravity=[0.0, -GRAVITY], upper=[3.0, 1.0]).to_dict()
    data["contact"], laws = {"stepping": "implicit"}, [walls | {"between": "walls"}, STICKING | {"between": "pairs"}]
    alone, beside = (run_to_end(scene_from_dict(data | {"interaction": laws[:count]})) for count in (1, 2))
    assert alone.twist.velocity[0, 0] < 0.75
    np.testing.assert_allclose(beside.twist.velocity, alone.twist.velocity, atol=1e-6)
    assert_keeps_its_account(beside)


@pytest.mark.parametrize("held", [1e-3, 5e-2], ids=["sticks", "slips"])
def test_a_contact_of_sign_minus_one_takes_away_what_another_gives(held):
    options = SpringDashpotOptions(stiffness=3.0, restitution=0.5, friction=0.4, tangential_stiffness=2.0)
    law = SignedLaw(SpringDashpotLaw(options, 0.2))
    point, normal = np.array([[0.3, 0.1]] * 2), np.array([[0.0, 1.0]] * 2)
    numbers, gap, flat, sign = np.array([0, 0]), np.full(2, 0.15), np.full(2, np.inf), np.array([1.0, -1.0])
    start = Contacts(numbers, numbers + 1, point + gap[:, None] * normal, point, normal, gap, flat, flat, numbers > 0)
    start = replace(start, sign=sign)
    middle = contacts_of_mean_force(law, start, start, np.full(2, 0.11), 0.2 * sign)
    np.testing.assert_allclose(middle.gap, 0.2 - 0.2 / 3.0)
    slip = Slip(Motion(np.array([[0.2, -0.1]] * 2), np.ones(2)), 0.1, np.zeros((2, 2)), False)
    found = rubbing(law, middle, start, np.array([[held, 0.0]] * 2), slip)
    assert np.any(found.force[0] != 0.0)
    np.testing.assert_array_equal(found.force[1], -found.force[0])
    np.testing.assert_array_equal(found.stiffness[1], -found.stiffness[0])
    np.testing.assert_array_equal(found.rise[1], found.rise[0])
    np.testing.assert_array_equal(found.displacement[1], found.displacement[0])


def test_a_belt_takes_a_disk_along():
    data = disk_on_slope(0.0, end=0.5, step=4e-3).to_dict()
    data["boundary"] = [{"on": "bottom", "type": "wall", "velocity": [0.5, 0.0]}]
    history = run(scene_from_dict(data))
    assert history.bodies["vx"][-1] == pytest.approx(0.5, rel=1e-3)
    assert abs(history.energy["residual"][-1]) < 1e-6 * history.energy["control"][-1]


def test_a_resumed_run_goes_on_with_the_same_bits(tmp_path):
    def scene(end):
        return scene_from_dict(disk_on_slope(0.9, end, 4e-3).to_dict() | {"output": {"every": 0.1}})

    run(scene(0.2), tmp_path / "whole")
    run(scene(0.1), tmp_path / "resumed")
    run(scene(0.2), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    np.testing.assert_array_equal(whole.springs.displacement, resumed.springs.displacement)
    np.testing.assert_array_equal(whole.pose.position, resumed.pose.position)
    assert whole.ledger == resumed.ledger
