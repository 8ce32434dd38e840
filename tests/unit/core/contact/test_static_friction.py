"""Springs along surfaces hold what rests on a slope, let it slide by Coulomb's law, and make balls roll."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from ended_runs import run_to_end
from slopes import FRICTION, GRAVITY, RADIUS, SIDE, SQUARE, STICKING, block_on_slope, sliding_ball

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.output.checkpoint import read_checkpoint
from rigidfluid.core.run.run import run
from rigidfluid.errors import SceneError


@pytest.mark.parametrize(
    ("steepness", "end", "slipped"),
    [(0.9, 0.8, 0.02), pytest.param(0.99, 2.6, 0.1, marks=[pytest.mark.long, pytest.mark.nightly])],
)
def test_a_block_rests_on_a_slope_that_friction_holds(steepness, end, slipped):
    """It starts with relaxed springs, and slips until the excess of friction over its weight has stopped it."""
    state = run_to_end(block_on_slope(steepness, end))
    assert np.linalg.norm(state.twist.velocity) < 1e-5
    assert 0.0 < state.pose.position[0, 0] - 0.5 < slipped
    shear = np.sum(state.springs.stiffness[:, None] * state.springs.displacement, axis=0)
    weight = SIDE**2 * GRAVITY * np.sin(np.arctan(steepness * FRICTION))
    assert shear == pytest.approx([weight, 0.0], rel=1e-3)


def test_without_the_spring_it_creeps():
    state = run_to_end(block_on_slope(0.99, end=0.3, tangential_stiffness=None))
    assert state.twist.velocity[0, 0] > 0.01
    assert state.springs is None


@pytest.mark.long
def test_a_block_slides_on_a_steeper_slope():
    middle, end = (run_to_end(block_on_slope(1.01, end=time)) for time in (0.5, 1.0))
    angle = np.arctan(1.01 * FRICTION)
    acceleration = GRAVITY * (np.sin(angle) - FRICTION * np.cos(angle))
    gained = end.twist.velocity[0, 0] - middle.twist.velocity[0, 0]
    assert gained == pytest.approx(0.5 * acceleration, rel=0.01)


@pytest.mark.parametrize("step", [4e-3, 2e-3, 1e-3, 5e-4])
def test_a_sliding_ball_ends_in_rolling_and_no_energy_is_made(step):
    """Friction leaves the momentum about the point of contact: the speed falls to 1/(1 + I/(m a²)) of it, a its arm."""
    state = run_to_end(sliding_ball(end=0.2, step=step))
    arm = state.pose.position[0, 2] - 0.5 * state.contacts.gap.min()
    rolling = 1.0 / (1.0 + 0.4 * (RADIUS / arm) ** 2)
    velocity, spin = state.twist.velocity[0], state.twist.angular_velocity[0]
    assert velocity[0] == pytest.approx(rolling, rel=5e-3)
    assert spin[1] * arm == pytest.approx(velocity[0], rel=1e-2)
    assert abs(state.ledger.residual) < 5e-3 * state.ledger.initial
    lost = 0.5 * 4.0 / 3.0 * np.pi * RADIUS**3 * (1.0 - rolling)
    assert state.ledger.contact_loss == pytest.approx(lost, rel=0.02)


def test_a_ball_that_hits_obliquely_keeps_its_energy_where_it_sticks():
    """Without dashpots and with rough surfaces all energy comes back, part of it as spin, if both springs swing alike:
    a disk's effective mass along the surfaces is m/(1 + m a²/I)."""
    stiffness = STICKING["stiffness"] / (1.0 + 2.0 * (1.1 * RADIUS / RADIUS) ** 2)
    contact = STICKING | {"restitution": 1.0, "friction": 50.0, "tangential_stiffness": stiffness}
    body = ball([0.5, 0.2], [0.1, -0.2])
    state = run_to_end(dry_scene(contact, body, end=1.0, step=1e-3))
    assert state.springs is None
    assert abs(state.twist.angular_velocity[0, 0]) > 0.1
    assert abs(state.ledger.residual) < 1e-3 * state.ledger.initial
    assert abs(state.ledger.contact_loss) < 1e-2 * state.ledger.initial


@pytest.mark.parametrize("substeps", [8, 32])
@pytest.mark.parametrize("speed", [0.5, 3.0])
def test_a_dashpot_makes_no_energy_in_an_oblique_impact(speed, substeps):
    """Fast slip ends in sticking, or with the contact; springs hold no energy before surfaces have moved."""
    contact = STICKING | {"stiffness": 400.0, "tangential_stiffness": 114.0, "restitution": 0.2, "friction": 0.3}
    body = ball([0.5, 0.125], [speed, -0.5])
    scene = dry_scene(contact | {"substeps": substeps}, body, end=0.1, step=1e-3, upper=[3.0, 1.0])
    energy = run(scene).energy
    assert np.all(np.diff(energy["contact_loss"]) >= -1e-12)
    assert energy["contact_loss"][-1] > 0.1 * energy["kinetic"][0]
    assert energy["contact"].max() < 0.2 * energy["kinetic"][0]
    assert np.abs(energy["residual"]).max() < 1e-4 * energy["kinetic"][0]


def test_a_block_stays_where_it_is_on_a_belt():
    data = block_on_slope(0.0, end=0.5).to_dict()
    data["boundary"] = [{"on": "bottom", "type": "wall", "velocity": [0.5, 0.0]}]
    history = run(scene_from_dict(data))
    assert history.bodies["vx"][-1] == pytest.approx(0.5, rel=1e-3)
    energy = history.energy
    assert abs(energy["residual"][-1]) < 5e-3 * energy["control"][-1]


def test_a_run_that_is_resumed_while_it_sticks_goes_on_with_the_same_bits(tmp_path):
    def scene(end):
        return scene_from_dict(block_on_slope(0.9, end).to_dict() | {"output": {"every": 0.1}})

    run(scene(0.3), tmp_path / "whole")
    run(scene(0.2), tmp_path / "resumed")
    assert len(read_checkpoint(tmp_path / "resumed" / "state.h5").state.springs) == 2
    run(scene(0.3), tmp_path / "resumed", resume=True)
    whole, resumed = (read_checkpoint(tmp_path / name / "state.h5").state for name in ("whole", "resumed"))
    for record in ("pose", "twist", "springs"):
        for name in getattr(whole, record).__slots__:
            np.testing.assert_array_equal(
                getattr(getattr(whole, record), name), getattr(getattr(resumed, record), name)
            )
    assert whole.ledger == resumed.ledger


@pytest.mark.long
def test_a_shorter_plan_resolves_stiff_springs():
    """Substeps that did not know of these springs would explode."""
    state = run_to_end(block_on_slope(0.5, end=0.1, step=0.02, tangential_stiffness=4e4))
    assert np.linalg.norm(state.twist.velocity) < 0.1
    assert abs(state.ledger.residual) < 5e-3 * abs(state.ledger.gravity)


def test_two_such_laws_in_one_contact_are_refused():
    data = block_on_slope(0.9, end=0.1).to_dict()
    data["interaction"] = [STICKING | {"names": ["bottom"]}]
    with pytest.raises(SceneError, match=r"interaction\.0\.friction.*contact has one"):
        build_system(scene_from_dict(data))


def test_one_for_walls_and_one_for_pairs_act_as_one():
    block = {"type": "polygon", "points": SQUARE, "density": 1.0, "position": [0.5, 0.1199]}
    lists = [STICKING | {"between": between} for between in ("walls", "pairs")]
    scenes = [dry_scene(STICKING, block, end=0.1, step=2e-3, gravity=[4.0, -GRAVITY], upper=[3.0, 1.0]).to_dict()] * 2
    scenes[1] = scenes[1] | {"contact": {}, "interaction": lists}
    one, both = (run_to_end(scene_from_dict(scene)) for scene in scenes)
    np.testing.assert_array_equal(one.pose.position, both.pose.position)
