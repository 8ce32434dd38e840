"""Balls that friction stops from rolling and from spinning about the normal, and holds on slopes, in substeps and
implicit steps."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from ended_runs import run_to_end
from slopes import GRAVITY, RADIUS, RANGE, STICKING

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.errors import SceneError

ROLLING = STICKING | {"restitution": 0.5, "rolling_friction": 0.1, "twisting_friction": 0.05}
MASS = 4.0 / 3.0 * np.pi * RADIUS**3
HEIGHT = RADIUS + RANGE - MASS * GRAVITY / STICKING["stiffness"]
ARM = 0.5 * (HEIGHT + RADIUS)
"""Of the forces along the floor: they act in the middle of the gap."""


SUBSTEPS, IMPLICIT = {}, {"stepping": "implicit"}
IN_STEPS = pytest.mark.parametrize(
    ("keys", "step"),
    [
        pytest.param(SUBSTEPS, 4e-3, id="substeps"),
        pytest.param(IMPLICIT, 4e-3, id="implicit"),
        pytest.param(IMPLICIT, 5e-4, id="short implicit steps", marks=[pytest.mark.long, pytest.mark.nightly]),
    ],
)
IN_BOTH = pytest.mark.parametrize("keys", [SUBSTEPS, IMPLICIT], ids=["substeps", "implicit"])


def on_the_floor(end, slope=0.0, step=4e-3, contact=ROLLING, speed=0.0, spin=0.0, **keys):
    """A ball that presses with its weight on a floor of this slope, and rolls along x and spins about the normal."""
    angle = np.arctan(slope)
    gravity = GRAVITY * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    height = RADIUS + RANGE - MASS * GRAVITY * np.cos(angle) / STICKING["stiffness"]
    turning = [0.0, speed / ARM, spin]
    body = ball([0.3, 0.5, height], [speed, 0.0, 0.0], angular_velocity=turning)
    return dry_scene(contact | keys, body, end=end, step=step, gravity=gravity.tolist(), upper=[3.0, 1.0, 1.0])


def assert_keeps_its_account(state, keys):
    ledger = state.ledger
    allowed = 1e-8 if keys is IMPLICIT else 2e-3
    assert abs(ledger.residual) < allowed * (ledger.initial + abs(ledger.gravity))
    assert ledger.contact_loss > 0.0


@IN_STEPS
def test_a_ball_stops_where_rolling_friction_has_taken_its_energy(keys, step):
    """The couple μ_r R m g slows it by μ_r R g/a/(1 + I/(m a²)), where a is its arm."""
    speed = 0.4
    slowing = 0.1 * RADIUS * GRAVITY / ARM / (1.0 + 0.4 * (RADIUS / ARM) ** 2)
    stopped = speed / slowing
    state = run_to_end(on_the_floor(stopped + 0.4, step=step, speed=speed, **keys))
    assert state.pose.position[0, 0] - 0.3 == pytest.approx(0.5 * speed**2 / slowing, rel=0.02)
    assert np.linalg.norm(state.twist.velocity) < 0.01 * speed
    assert_keeps_its_account(state, keys)


@IN_BOTH
def test_a_ball_rests_on_a_slope_below_that_of_rolling_friction_and_rolls_on_a_steeper_one(keys):
    greatest = 0.1 * RADIUS / ARM
    rests = run_to_end(on_the_floor(0.6, slope=0.95 * greatest, **keys))
    assert np.linalg.norm(rests.twist.velocity) < 1e-3
    assert rests.springs.turning[0, 1] > 0.0
    middle, end = (run_to_end(on_the_floor(time, slope=1.1 * greatest, **keys)) for time in (0.3, 0.6))
    angle = np.arctan(1.1 * greatest)
    driving = GRAVITY * (np.sin(angle) - greatest * np.cos(angle)) / (1.0 + 0.4 * (RADIUS / ARM) ** 2)
    gained = end.twist.velocity[0, 0] - middle.twist.velocity[0, 0]
    assert gained == pytest.approx(0.3 * driving, rel=0.02)
    for state in (rests, end):
        assert_keeps_its_account(state, keys)


@pytest.mark.long
@IN_STEPS
def test_a_spin_about_the_normal_stops_in_time(keys, step):
    """I dw/dt = -μ_o R m g, with I = .4 m R²."""
    spin, slowing = 10.0, 0.05 * GRAVITY / (0.4 * RADIUS)
    times = 0.4, spin / slowing + 0.3
    middle, end = (run_to_end(on_the_floor(time, step=step, spin=spin, **keys)) for time in times)
    assert middle.twist.angular_velocity[0, 2] == pytest.approx(spin - 0.4 * slowing, rel=0.01)
    assert abs(end.twist.angular_velocity[0, 2]) < 0.02 * spin
    assert np.linalg.norm(end.twist.angular_velocity[0, :2]) < 1e-9
    assert_keeps_its_account(end, keys)
    assert end.ledger.contact_loss == pytest.approx(0.2 * MASS * RADIUS**2 * spin**2, rel=0.02)


@IN_BOTH
def test_a_ball_that_may_twist_goes_on_spinning(keys):
    state = run_to_end(on_the_floor(0.2, spin=10.0, twisting_friction=0.0, **keys))
    assert state.twist.angular_velocity[0, 2] == pytest.approx(10.0, rel=1e-12)


@IN_BOTH
def test_disks_stop_each_other_from_turning(keys):
    """Two in a row of forces: the couple is opposite on both, so their angular momentum stays."""
    bodies = [ball([0.3 + x, 0.5], [v, 0.0], angular_velocity=w) for x, v, w in ((0.0, 0.1, 3.0), (0.215, -0.1, -1.0))]
    contact = ROLLING | {"restitution": 0.9, "friction": 1e-9, "twisting_friction": 0.0}
    state = run_to_end(dry_scene(contact | keys, *bodies, end=0.4, step=2e-3))
    spins = state.twist.angular_velocity[:, 0]
    assert spins.sum() == pytest.approx(2.0, abs=1e-6)
    assert 0.0 < spins[0] - spins[1] < 3.9
    assert_keeps_its_account(state, keys)


def test_substeps_and_implicit_steps_agree():
    ends = [run_to_end(on_the_floor(0.1, speed=0.4, spin=8.0, **keys)).twist for keys in (SUBSTEPS, IMPLICIT)]
    for one, other in zip(*((end.velocity, end.angular_velocity) for end in ends), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-12)


def test_a_belt_turns_a_ball_no_faster_than_its_bearing_lets_it():
    """A floor that turns in itself spins a ball that stands still on it, by at most μ_o R m g."""
    data = on_the_floor(0.2, **IMPLICIT).to_dict()
    data["boundary"] = [{"on": "back", "type": "wall", "angular_velocity": [0.0, 0.0, 30.0], "centre": [0.3, 0.5, 0.0]}]
    history = run(scene_from_dict(data))
    assert history.bodies["wz"][-1] == pytest.approx(0.2 * 0.05 * GRAVITY / (0.4 * RADIUS), rel=0.01)
    assert abs(history.energy["residual"][-1]) < 1e-8 * history.energy["control"][-1]


def test_fast_turning_stretches_no_spring_backwards():
    """Its dashpots alone would give several times the bound."""
    state = run_to_end(on_the_floor(0.1, speed=0.4, spin=8.0))
    assert np.abs(state.springs.turning).max() < 1e-15
    assert abs(state.ledger.residual) < 1e-5 * state.ledger.initial


@IN_BOTH
def test_a_run_resumed_while_it_rolls_goes_on_with_the_same_bits(tmp_path, keys):
    def scene(end):
        floor = on_the_floor(end, speed=0.4, spin=4.0, tangential_damping=0.01, **keys)
        return scene_from_dict(floor.to_dict() | {"output": {"every": 0.1}})

    run(scene(0.2), tmp_path / "whole")
    run(scene(0.1), tmp_path / "resumed")
    run(scene(0.2), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    assert (whole.springs.turning[0, 1:] != 0.0).all()  # it rolls about y and twists about z
    for name in whole.springs.__slots__:
        np.testing.assert_array_equal(getattr(whole.springs, name), getattr(resumed.springs, name))
    np.testing.assert_array_equal(whole.twist.angular_velocity, resumed.twist.angular_velocity)
    assert whole.ledger == resumed.ledger


@pytest.mark.parametrize(
    ("keys", "field"),
    [
        ({"tangential_stiffness": None}, "tangential_stiffness"),
        ({"rolling_friction": -0.1}, "rolling_friction"),
    ],
)
def test_keys_that_do_not_fit_are_refused(keys, field):
    with pytest.raises(SceneError, match=field):
        build_system(on_the_floor(0.1, **keys))


def test_it_is_for_round_surfaces():
    block = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "density": 1.0, "position": [0.5, 0.5]}
    with pytest.raises(SceneError, match=r"rolling_friction: found 0\.1 for .*Set it to 0, or"):
        build_system(dry_scene(ROLLING, block, end=0.1, step=1e-3))
