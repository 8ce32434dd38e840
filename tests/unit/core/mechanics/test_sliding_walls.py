"""Walls that slide in themselves: what they do to the fluid, to bodies that rub on them, and to the energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.case.system import build_system
from rigidfluid.core.geometry.surface import Plane
from rigidfluid.core.geometry.wall import Wall
from rigidfluid.core.mechanics.wall_velocity import SlidingWalls, WallVelocity
from rigidfluid.core.run.run import run
from rigidfluid.core.scene.scene import Scene
from rigidfluid.core.setup.features import features
from rigidfluid.errors import SceneError

BELT = {"on": "bottom", "type": "wall", "velocity": [0.5, 0.0]}
RUBBING = {"law": "spring-dashpot", "range": 0.02, "stiffness": 400.0, "damping": 1.0, "friction": 0.4}
RADIUS, GRAVITY = 0.1, 10.0
SLIPPING = {"end": 0.03, "step": 0.001}


def scene(boundary: list[dict[str, Any]], **tables: Any) -> Scene:
    body = {"type": "sphere", "radius": RADIUS, "density": 1.0, "position": [1.0, RADIUS + 0.0192]}
    tables = {"contact": RUBBING, "body": [body]} | tables
    return scene_from_dict(
        {
            "scene": {"name": "belt", "dimension": 2},
            "fluid": {"backend": "dry", "gravity": [0.0, -GRAVITY]},
            "domain": {"lower": [0.0, 0.0], "upper": [4.0, 1.0]},
            "boundary": boundary,
            "time": {"end": 0.1, "step": 0.001},
            "output": {"every": 0.1},
            **tables,
        }
    )


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_a_belt_takes_a_ball_along_by_friction(stepping: str) -> None:
    """While it slips, friction μ m g accelerates it by μ g, and turns it by μ m g a/I at the arm a to mid-gap."""
    history = run(scene([BELT], contact=RUBBING | {"stepping": stepping}, time=SLIPPING))
    speed = RUBBING["friction"] * GRAVITY * SLIPPING["end"]
    assert history.bodies["vx"][-1] == pytest.approx(speed, rel=0.02)
    assert history.bodies["w"][-1] == pytest.approx(2.0 * speed * (RADIUS + 0.0096) / RADIUS**2, rel=0.02)


def test_in_the_end_the_ball_rolls_on_the_belt() -> None:
    history = run(scene([BELT], time={"end": 0.2, "step": 0.001}))
    surface = history.bodies["vx"][-1] + history.bodies["w"][-1] * (RADIUS + 0.0096)
    assert surface == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("stepping", ["substeps", "implicit"])
def test_the_power_of_the_belt_is_counted(stepping: str) -> None:
    """What the belt gives is what the ball has, and what friction has taken; the ball slips all the while."""
    history = run(scene([BELT], contact=RUBBING | {"stepping": stepping}, time=SLIPPING))
    energy = history.energy
    mass, speed = np.pi * RADIUS**2, history.bodies["vx"][-1]
    assert energy["control"][-1] == pytest.approx(mass * speed * 0.5, rel=1e-6)
    assert energy["contact_loss"][-1] > 0.5 * energy["control"][-1]
    assert abs(energy["residual"][-1]) < 0.01 * energy["control"][-1]


def test_a_ball_that_rolls_with_a_belt_at_rest_is_left_alone() -> None:
    history = run(scene([BELT | {"velocity": [0.0, 0.0]}]))
    assert np.abs(history.bodies["vx"]).max() == 0.0
    assert history.energy["control"][-1] == 0.0


def test_a_wall_that_slides_moves_fluid_and_ball_along() -> None:
    """Couette flow around a ball of the fluid's density, at three quarters of the height."""
    ends = [{"on": side, "type": "pressure", "pressure": 0.0} for side in ("left", "right")]
    body = {"type": "sphere", "radius": 0.05, "density": 1.0, "position": [1.0, 0.75]}
    lid = {"on": "top", "type": "wall", "velocity": [1.0, 0.0]}
    history = run(
        scene(
            [lid, *ends],
            body=[body],
            contact={},
            fluid={"density": 1.0, "viscosity": 1.0},
            domain={"lower": [0.0, 0.0], "upper": [2.0, 1.0]},
            mesh={"size": 0.2, "size_body": 0.04},
            time={"end": 1.0, "step": 0.05},
            output={"every": 1.0},
        )
    )
    assert history.bodies["vx"][-1] == pytest.approx(0.75, rel=0.02)
    assert history.bodies["w"][-1] == pytest.approx(-0.5, rel=0.05)
    energy = history.energy
    assert energy["boundary"][-1] > 1.0
    assert abs(energy["residual"][-1]) < 0.02 * energy["boundary"][-1]


def test_the_system_knows_the_velocity_by_surface_number() -> None:
    system = build_system(scene([BELT]))
    assert system.wall_velocity is not None
    velocity = system.wall_velocity(np.arange(5), np.ones((5, 2)))
    np.testing.assert_array_equal(velocity, [[0, 0], [0, 0], [0, 0], [0.5, 0], [0, 0]])
    assert build_system(scene([])).wall_velocity is None
    told = {feature.name: (feature.on, feature.why) for feature in features(system, None)}
    assert told["walls that slide"] == (True, "bottom")


def test_a_velocity_across_a_wall_is_refused_by_name() -> None:
    with pytest.raises(SceneError, match=r"boundary.0.velocity: .* 0.2 across the wall 'bottom'.*\[0.5, 0.0\]"):
        scene([BELT | {"velocity": [0.5, 0.2]}])


def test_a_velocity_of_all_walls_is_across_some() -> None:
    with pytest.raises(SceneError, match=r"across the wall 'left'"):
        scene([BELT | {"on": "all"}])


def test_a_profile_is_no_matter_of_walls() -> None:
    with pytest.raises(SceneError, match=r"0.profile: profile is valid only with type = 'velocity', not 'wall'"):
        scene([BELT | {"profile": "parabolic"}])


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_angular_velocity_of_a_wall_that_turns_is_known_too(dimension: int) -> None:
    spin = np.array([0.7]) if dimension == 2 else np.array([0.7, -0.2, 0.4])
    turning = WallVelocity(np.ones(dimension), spin, np.full(dimension, 3.0))
    floor = Plane(np.zeros(dimension), np.eye(dimension)[1])
    walls = SlidingWalls([Wall(5, "drum", floor, turning), Wall(6, "belt", floor, lambda x: np.ones_like(x))])
    points = np.random.default_rng(0).normal(size=(3, dimension))
    found = walls.angular_velocity(np.array([4, 5, 6]), points)
    np.testing.assert_allclose(found, [0.0 * spin, spin, 0.0 * spin], rtol=0, atol=1e-12)
