"""Actions and observations: what they are called with, their bounds, their effect on a run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from small_tasks import MASS, STEP, blown, channel, drag, dry_scene, joined, pushed

from rigidfluid.api import ArgumentError, SceneError, scene_from_dict
from rigidfluid.core.case.scene_model import model_of
from rigidfluid_gymnasium import (
    AppliedWrench,
    BodyValue,
    BoundaryFactor,
    FluidEnv,
    JointDrive,
    JointValue,
    PrescribedTwist,
    ProbeValue,
    Task,
)
from rigidfluid_gymnasium.course import Course


@pytest.mark.parametrize("task", [pushed(), joined(), blown()], ids=["pushed", "joined", "blown"])
def test_gymnasium_finds_no_fault(task: Task) -> None:
    """Its warnings are errors here."""
    check_env(FluidEnv(task), skip_render_check=True)


def test_a_force_moves_a_body_as_newton_says_and_a_constant_one_takes_no_entry() -> None:
    env = FluidEnv(pushed(actions=[AppliedWrench("disk", low=(-2.0, 1.0, 0.0), high=(2.0, 1.0, 0.0))]))
    env.reset(seed=0)
    assert env.action_space.shape == (1,)
    seen, reward, *_ = env.step(np.array([0.5]))
    time = 4 * STEP
    np.testing.assert_allclose(seen[2:], np.array([1.0, 1.0]) / MASS * time, rtol=1e-12)
    np.testing.assert_allclose(seen[:2], 5.0 + 0.5 * time**2 / MASS, rtol=1e-3)
    assert reward == pytest.approx(seen[0] - 5.0)


def test_a_prescribed_twist_is_reached_by_the_next_action() -> None:
    twist = PrescribedTwist("disk", low=(-1.0, 0.0, 3.0), high=(1.0, 0.0, 3.0))
    disk = {"name": "disk", "type": "sphere", "radius": 0.5, "density": 1.0, "position": [5.0, 5.0], "fixed": True}
    env = FluidEnv(pushed(dry_scene(2.0, disk), actions=[twist]))
    env.reset(seed=0)
    seen, *_ = env.step(np.array([1.0]))
    np.testing.assert_allclose(seen, [5.0 + 0.5 * 4 * STEP, 5.0, 1.0, 0.0], rtol=1e-12, atol=1e-12)
    assert env.run.bodies["disk"].angular_velocity == pytest.approx(3.0)
    assert env.step(np.array([-1.0]))[0][2] == pytest.approx(-1.0)


def test_a_driven_joint_is_where_it_was_sent_at_rest_and_on_its_way_between() -> None:
    env = FluidEnv(joined())
    env.reset(seed=0)
    for action, target in ((1.0, 1.5), (-1.0, -0.5), (0.0, 0.5)):
        seen, *_ = env.step(np.array([action]))
        np.testing.assert_allclose(seen, [target, 0.0], atol=1e-9)
    position = {name: body.position[0] for name, body in env.run.bodies.items()}
    assert position["other"] - position["disk"] == pytest.approx(3.5)
    assert sum(position.values()) == pytest.approx(9.0)  # nothing from outside moves them
    env.reset(seed=0)
    before = env.run.time
    env.step(np.array([1.0]))
    way = env.run.history.joints
    halfway = np.searchsorted(way["time"], before + 4 * STEP)
    assert way["displacement"][halfway] == pytest.approx(0.75, rel=1e-6)


def test_a_factor_on_the_boundary_is_reached_by_the_next_action() -> None:
    env = FluidEnv(blown())
    env.reset(seed=0)
    drags = []
    for action, speed in ((1.0, 2.0), (-1.0, 0.0), (-0.5, 0.5)):
        seen, reward, *_ = env.step(np.array([action, 0.0]))
        assert seen[0] == pytest.approx(speed, abs=1e-12)
        drags.append(reward)
    assert drags[0] == pytest.approx(4.0 * drags[2], rel=1e-6)  # Stokes flow is linear
    assert drags[1] == pytest.approx(0.0, abs=1e-6 * drags[0])
    assert seen[3] == pytest.approx(drags[2])


def test_a_pressure_is_scaled_too() -> None:
    scene = channel().to_dict()
    scene["boundary"][0] = {"on": "left", "type": "pressure", "pressure": 8.0}
    probe = ProbeValue((0.0, 1.0), "pressure", low=-99.0, high=99.0)
    actions = [BoundaryFactor("left", low=-1.0, high=3.0)]
    env = FluidEnv(blown(case=scene_from_dict(scene), actions=actions, observations=[probe]))
    env.reset(seed=0)
    up, down = (env.step(np.array([action]))[0][0] for action in (1.0, -1.0))
    assert up == pytest.approx(24.0, rel=0.01)
    assert up == pytest.approx(-3.0 * down, rel=1e-6)


THROUGH = [{"on": side, "type": "velocity", "velocity": [1.0, 0.0]} for side in ("left", "right")]


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"actions": [JointDrive("leg", low=0.0, high=1.0)]}, "found 'leg'; allowed is a joint of the scene: it has"),
        ({"actions": [BoundaryFactor("rim", low=0.0, high=1.0)]}, "found 'rim'; allowed is a surface of the domain: "),
        ({"actions": [BoundaryFactor("left", low=0.0, high=1.0)]}, "found 'wall' on 'left'; allowed is 'velocity' or"),
        ({"actions": [AppliedWrench("disc", low=0.0, high=1.0)]}, "body: found 'disc', which is not there"),
        ({"observations": [BodyValue("disc", "position", low=0.0, high=1.0)]}, "body: found 'disc'; allowed is one"),
        ({"observations": [JointValue("leg", low=0.0, high=1.0)]}, "joint: found 'leg'; allowed is one that is there"),
        ({"observations": [ProbeValue((1.0, 1.0), "pressure", low=0.0, high=1.0)]}, "found a run without a fluid"),
    ],
    ids=lambda value: None if isinstance(value, dict) else value[:24],
)
def test_what_the_scene_does_not_have_is_named(others: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):  # noqa: PT012  some are known where an episode begins, others later
        env = FluidEnv(pushed(**others))
        env.reset(seed=0)
        env.step(np.ones(env.action_space.shape))


def test_a_joint_with_a_drive_of_its_own_is_refused() -> None:
    task = joined(drive={"smooth": [[0.0, 0.0], [1.0, 0.4], [2.0, 0.0]]})
    with pytest.raises(SceneError, match="joint 'arm': found one with a drive of its own"):
        FluidEnv(task).reset()


def test_a_factor_that_lets_more_in_than_out_is_refused_before_the_episode() -> None:
    closed = scene_from_dict(channel().to_dict() | {"boundary": THROUGH})
    with pytest.raises(SceneError, match=r"a net inflow of .* and no outlet"):
        FluidEnv(blown(case=closed)).reset()


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"actions": []}, "Task: found 0 actions and 1 observations"),
        ({"steps_per_action": 0}, "steps_per_action: found 0; allowed is at least 1"),
        ({"actions": [JointDrive("arm", low=0.0, high=1.0)]}, "steps_per_action: found 2; allowed is at least 4"),
        ({"actions": [AppliedWrench("disk", low=0.0, high=1.0)] * 2}, "found 2 of type AppliedWrench on 'disk'"),
        ({"actions": [AppliedWrench("disk", low=0.0, high=0.0)]}, "found constant values alone"),
        ({"actions": [AppliedWrench("disk", low=1.0, high=0.0)]}, r"AppliedWrench\(disk\).high: found .* below 'low'"),
        ({"actions": [AppliedWrench("disk", low=(0.0, 0.0), high=1.0)]}, r"\(disk\).low: .* a finite number, or 3 of"),
        ({"actions": [AppliedWrench("disk", low=-np.inf, high=1.0)]}, r"\(disk\).low: found -inf"),
        (
            {"observations": [BodyValue("disk", "gap", low=1.0, high=1.0)]},
            r"\(disk, gap\): found 'low' and 'high' at 1",
        ),
    ],
    ids=lambda value: None if isinstance(value, dict) else value[:24],
)
def test_tasks_that_cannot_be_are_refused(others: dict[str, Any], message: str) -> None:
    given = {"observations": [BodyValue("disk", "gap", low=0.0, high=9.0)], "steps_per_action": 2, "reward": drag}
    with pytest.raises(ArgumentError, match=message):
        FluidEnv(pushed(**given | others))


@pytest.mark.parametrize("action", [[1.1, 0.0], [0.0], [np.nan, 0.0]])
def test_an_action_outside_the_space_is_refused(action: list[float]) -> None:
    env = FluidEnv(pushed())
    env.reset(seed=0)
    with pytest.raises(ArgumentError, match="allowed is 2 numbers from -1 to 1"):
        env.step(np.array(action))


def test_what_is_seen_beyond_its_bounds_is_clipped_and_told() -> None:
    seen = BodyValue("disk", "position", low=0.0, high=(5.0, 6.0)), BodyValue("disk", "velocity", low=-9.0, high=9.0)
    env = FluidEnv(pushed(observations=seen))
    assert "clipped" not in env.reset(seed=0)[1]
    observed, *_, info = env.step(np.array([1.0, 0.0]))
    assert observed[0] == 5.0 < env.run.bodies["disk"].position[0]
    assert info["clipped"] == ["BodyValue(disk, position)"]


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda bounds: BodyValue("disk", "velocty", **bounds), "BodyValue.quantity: found 'velocty'.*'velocity'"),
        (
            lambda bounds: JointValue("hinge", "angle", **bounds),
            "JointValue.quantity: found 'angle'.*one of value, rate",
        ),
        (lambda bounds: ProbeValue([0.5, 0.5], "speed", **bounds), "ProbeValue.quantity: found 'speed'"),
    ],
)
def test_quantities_that_there_are_not_are_refused(make: Any, told: str) -> None:
    with pytest.raises(ArgumentError, match=told):
        make({"low": -1.0, "high": 1.0})


def test_factors_know_both_names_of_faces() -> None:
    factors = [BoundaryFactor(name, low=0.5, high=1.0) for name in ("left", "xmin")]
    model = model_of(channel())
    scaled = [factor.followed_by(model, Course(np.array([0.5]))).boundary for factor in factors]
    assert [set(boundary) for boundary in scaled] == [set(model.boundary) | {"left"}] * 2
    with pytest.raises(SceneError, match="left or xmin, right or xmax"):
        BoundaryFactor("roof", low=0.5, high=1.0).followed_by(model, Course(np.array([0.5])))
