"""Friction that any law may have: static, sliding, rolling, and in impacts, by the law's own stiffness."""

import numpy as np
import pytest
from dry_scenes import ball, dry_scene
from ended_runs import run_to_end
from slopes import FRICTION, GRAVITY, RADIUS, RANGE

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.contact.laws.friction import Friction, Rubbing
from rigidfluid.core.contact.laws.repulsion import RepulsionOptions
from rigidfluid.core.mechanics.coulomb import TurningFriction
from rigidfluid.errors import SceneError
from rigidfluid.forces.normal import NormalLaw

LAWS = "normal", "contact", "barrier"
RUBBING = {"range": RANGE, "epsilon": "auto", "restitution": 0.2, "friction": FRICTION}


def disk_on_slope(law, steepness, end):
    """A disk that cannot turn, on a plane whose slope is ``steepness`` times the coefficient of friction."""
    angle = np.arctan(steepness * FRICTION)
    gravity = GRAVITY * np.array([np.sin(angle), -np.cos(angle)])
    disk = ball([0.5, RADIUS + 0.5 * RANGE], [0.0, 0.0], free=["x", "y"])
    contact = RUBBING | {"law": law, "impact_speed": 0.3}
    return dry_scene(contact, disk, end=end, step=2e-3, gravity=gravity.tolist(), upper=[3.0, 1.0])


@pytest.mark.long
def test_a_disk_rests_on_a_slope_below_the_angle_and_slides_above():
    resting, sliding, later = (
        run_to_end(disk_on_slope("normal", steepness, end)) for steepness, end in ((0.8, 0.6), (1.05, 0.2), (1.05, 0.3))
    )
    assert np.linalg.norm(resting.twist.velocity) < 2e-3
    shear = np.sum(resting.springs.stiffness[:, None] * resting.springs.displacement, axis=0)
    assert shear[0] == pytest.approx(np.pi * RADIUS**2 * GRAVITY * np.sin(np.arctan(0.8 * FRICTION)), rel=0.01)
    angle = np.arctan(1.05 * FRICTION)
    acceleration = GRAVITY * (np.sin(angle) - FRICTION * np.cos(angle))
    gained = later.twist.velocity[0, 0] - sliding.twist.velocity[0, 0]
    assert gained == pytest.approx(0.1 * acceleration, rel=0.02)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("step", [4e-3, 1e-3])
def test_an_oblique_impact_slips_by_coulombs_law(law, step):
    """A fast ball at a shallow angle slips all the time: friction takes μ (1 + e) v_n of its speed along the wall, and
    its spin is that impulse's moment."""
    body = ball([0.2, 0.5, 0.16], [3.0, 0.0, -0.5])
    state = run_to_end(dry_scene(RUBBING | {"law": law}, body, end=0.3, step=step, upper=[3.0, 1.0, 1.0]))
    velocity, spin = state.twist.velocity[0], state.twist.angular_velocity[0]
    assert velocity[2] == pytest.approx(0.2 * 0.5, rel=0.02)
    lost = FRICTION * (0.5 + velocity[2])
    assert 3.0 - velocity[0] == pytest.approx(lost, rel=0.01)
    assert spin[1] == pytest.approx(lost / (0.4 * RADIUS), rel=0.1)  # the arm is half a gap longer than the radius
    assert abs(state.ledger.residual) < 1e-4 * state.ledger.initial


def test_a_steep_impact_of_a_rough_ball_turns_its_slip_back():
    """Where surfaces stick and nothing is lost, springs of 2/7 of the law's stiffness turn the velocity of the point of
    contact back, as balls of rubber do (Garwin, Am. J. Phys. 37 (1969) 88, doi:10.1119/1.1975420)."""
    contact = RUBBING | {"law": "normal", "restitution": 1.0, "friction": 20.0}
    body = ball([0.2, 0.5, 0.16], [0.1, 0.0, -0.5])
    state = run_to_end(dry_scene(contact, body, end=0.3, step=1e-3, upper=[3.0, 1.0, 1.0]))
    arm = RADIUS + 0.5 * 0.25 * RANGE
    slip = state.twist.velocity[0, 0] - arm * state.twist.angular_velocity[0, 1]
    assert slip < -0.05
    assert abs(state.ledger.residual) < 1e-3 * state.ledger.initial
    assert abs(state.ledger.contact_loss) < 1e-2 * state.ledger.initial


def system_of(**contact):
    return build_system(dry_scene(contact, ball([0.5, 0.5], [0.0, 0.0]), end=0.1, step=1e-2))


def test_without_friction_a_law_has_no_memory():
    normal = RUBBING | {"law": "normal", "impact_speed": 1.0}
    assert not system_of(**normal | {"friction": 0.0}).law.sticking
    assert not system_of(**normal | {"friction": None}).law.sticking
    assert system_of(**normal).law.sticking


@pytest.mark.parametrize(
    ("keys", "field"),
    [
        ({"friction": -0.1}, "friction"),
        ({"friction": None, "tangential_stiffness": 3.0}, "tangential_stiffness"),
        ({"friction": 0.0, "tangential_damping": 0.5}, "tangential_damping"),
        ({"tangential_stiffness": 0.0}, "tangential_stiffness"),
        ({"friction": None, "rolling_friction": 0.1}, "rolling_friction"),
        ({"twisting_friction": -0.1}, "twisting_friction"),
    ],
)
def test_numbers_that_make_no_friction_are_refused(keys, field):
    with pytest.raises(SceneError) as caught:
        system_of(**RUBBING | {"law": "normal", "impact_speed": 1.0} | keys)
    assert caught.value.subject == f"contact.{field}"


def test_a_law_that_attracts_has_no_friction():
    with pytest.raises(SceneError, match="a law that repels") as caught:
        system_of(law="van-der-waals", range=RANGE, hamaker=1e-3, cutoff=0.1 * RANGE, friction=0.3)
    assert caught.value.subject == "contact.law"


def test_friction_without_a_law_is_refused():
    data = dry_scene(RUBBING | {"law": "normal"}, ball([0.5, 0.5], [0.0, 0.0]), end=0.1, step=1e-2).to_dict()
    data["contact"] = {"friction": 0.3}
    with pytest.raises(SceneError, match="friction"):
        build_system(scene_from_dict(data))


@pytest.mark.parametrize(
    ("declared", "field"),
    [({"friction": 0.2}, "friction"), ({"sticking": True}, "friction"), ({"sign": "either"}, "tangential_stiffness")],
)
def test_friction_is_refused_where_it_would_count_twice_or_be_zero(declared, field):
    law = NormalLaw(RepulsionOptions(epsilon=1e-3), RANGE)
    for name, value in declared.items():
        setattr(law, name, value)
    with pytest.raises(SceneError) as caught:
        Friction(law, Rubbing(0.3, None, 1.0, 0.25 * RANGE, TurningFriction(0.0, 0.0)))
    assert caught.value.subject == f"contact.{field}"


@pytest.mark.parametrize(
    "keys", [{}, pytest.param({"stepping": "implicit"}, marks=pytest.mark.long)], ids=["substeps", "implicit"]
)
@pytest.mark.parametrize("law", [LAWS[0], *(pytest.param(law, marks=pytest.mark.long) for law in LAWS[1:])])
def test_rolling_and_twisting_are_resisted_by_any_law(law, keys):
    """A ball at rest on the floor rolls and spins, slowed by μ_r R F_n and μ_o R F_n."""
    contact = RUBBING | {"law": law, "impact_speed": 0.3, "rolling_friction": 0.1, "twisting_friction": 0.05} | keys
    gravity, speed, spin, time = [0.0, 0.0, -GRAVITY], 0.4, 10.0, 0.1

    def ball_after(end, height, **motion):
        return run_to_end(
            dry_scene(
                contact, ball([0.3, 0.5, height], **motion), end=end, step=2e-3, gravity=gravity, upper=[3.0, 1.0, 1.0]
            )
        )

    height = ball_after(0.5, RADIUS + 0.5 * RANGE, velocity=[0.0, 0.0, 0.0]).pose.position[0, 2]
    arm = 0.5 * (height + RADIUS)
    state = ball_after(time, height, velocity=[speed, 0.0, 0.0], angular_velocity=[0.0, speed / arm, spin])
    slowing = 0.1 * RADIUS * GRAVITY / arm / (1.0 + 0.4 * (RADIUS / arm) ** 2)
    assert speed - state.twist.velocity[0, 0] == pytest.approx(time * slowing, rel=0.03)
    slowed = 0.05 * GRAVITY / (0.4 * RADIUS)
    assert spin - state.twist.angular_velocity[0, 2] == pytest.approx(time * slowed, rel=0.03)
    assert abs(state.ledger.residual) < 1e-4 * state.ledger.initial


def test_rolling_friction_is_for_round_surfaces():
    block = {"type": "ellipsoid", "semi_axes": [0.1, 0.05], "density": 1.0, "position": [0.5, 0.5]}
    contact = RUBBING | {"law": "normal", "impact_speed": 1.0, "rolling_friction": 0.1}
    with pytest.raises(SceneError, match=r"rolling_friction: found 0\.1 for 'normal' .*Set it to 0, or"):
        build_system(dry_scene(contact, block, end=0.1, step=1e-2))
