"""The stiffness that is left to the loads, seen by whole dry runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scenes import dry_tables

import rigidfluid
from rigidfluid import Scene, scene_from_dict

RANGE, SMALLEST, RADIUS = 0.02, 0.006, 0.25
DIMENSIONS = [2, pytest.param(3, marks=pytest.mark.long)]
LAWS = ["centre", "normal", "contact", "barrier"]
START = 1.3 * RANGE
LOADS = [(0.0, 1e-2), (0.0, 1e2), (1e-1, 0.0), (1e3, 0.0), (1e-1, 1e-2), (1e3, 1e1)]
"""Gravity and speed at the start, so that weights and impact speeds are over four decades."""


def ball(height: float, velocity: float | None = None, **keys: Any) -> dict[str, Any]:
    """A ball above the middle of the floor; its centre is at ``height``, its speed upward."""
    moving = {} if velocity is None else {"velocity": velocity}
    return {"type": "sphere", "radius": RADIUS, "density": 2.0, "position": height} | moving | keys


def scene(law: str, dimension: int, gravity: float, *bodies: dict[str, Any], **contact: Any) -> Scene:
    """Balls in a box without a fluid, in steps that are small compared with the impact."""
    return scene_from_dict(
        dry_tables(
            *[_placed(body, dimension) for body in bodies],
            step=1.0,
            fluid={"gravity": _up(-gravity, 0.0, dimension)},
            domain={"lower": [0.0] * dimension, "upper": [2.0] * dimension},
            contact={"law": law, "range": RANGE, "epsilon": "auto", "smallest_gap": SMALLEST} | contact,
        )
    )


def _placed(body: dict[str, Any], dimension: int) -> dict[str, Any]:
    moving = {"velocity": _up(body["velocity"], 0.0, dimension)} if "velocity" in body else {}
    return body | {"position": _up(body["position"], 1.0, dimension)} | moving


def _up(component: float, others: float, dimension: int) -> list[float]:
    return [others, component, others][:dimension]


def smallest_gap(scene: Scene, speed: float, gravity: float) -> float:
    """Of a run over the impact and some time after it, seen in 120 steps."""
    fastest = np.sqrt(speed**2 + 2.0 * gravity * START)
    end = 4.0 * START / fastest
    data = scene.to_dict()
    data["time"] = {"end": end, "step": end / 120}
    data["output"]["every"] = end
    history = rigidfluid.run(scene_from_dict(data))
    assert history.summary["auto_epsilon"]
    return float(history.bodies["gap"].min())


@pytest.mark.parametrize("dimension", DIMENSIONS)
@pytest.mark.parametrize(("gravity", "speed"), LOADS)
@pytest.mark.parametrize("law", LAWS)
def test_drop_onto_the_floor_ends_at_the_smallest_gap(law: str, gravity: float, speed: float, dimension: int) -> None:
    drop = scene(law, dimension, gravity, ball(RADIUS + START, -speed))
    assert smallest_gap(drop, speed, gravity) == pytest.approx(SMALLEST, rel=0.02)


@pytest.mark.parametrize("dimension", DIMENSIONS)
@pytest.mark.parametrize("speed", [1e-2, 1e2])
@pytest.mark.parametrize("law", LAWS)
def test_head_on_impact_of_unequal_balls_ends_at_the_smallest_gap(law: str, speed: float, dimension: int) -> None:
    lower, upper = ball(0.7, speed), ball(0.7 + 2 * RADIUS + START, -0.5 * speed, density=20.0)
    assert smallest_gap(scene(law, dimension, 0.0, lower, upper), speed, 0.0) == pytest.approx(SMALLEST, rel=0.02)


@pytest.mark.parametrize(("gravity", "speed", "dimension"), [(*load, 2 + i % 2) for i, load in enumerate(LOADS)])
@pytest.mark.parametrize("law", LAWS)
def test_drop_onto_a_ball_ends_at_the_smallest_gap(law: str, gravity: float, speed: float, dimension: int) -> None:
    hit = float(np.sqrt(speed**2 + 2.0 * gravity * (START - RANGE)))
    held, falling = ball(0.7, fixed=True), ball(0.7 + 2 * RADIUS + START, -speed)
    drop = scene(law, dimension, gravity, held, falling, impact_speed=hit)
    assert smallest_gap(drop, speed, gravity) == pytest.approx(SMALLEST, rel=0.02)


def test_the_summary_says_what_was_chosen_and_why() -> None:
    drop = scene("normal", 2, 10.0, ball(1.0), ball(1.6, density=4.0), epsilon=1e-3, epsilon_wall="auto")
    data = drop.to_dict() | {"time": {"end": 1e-3, "step": 1e-3}, "output": {"every": 1e-3}}
    lower, upper = rigidfluid.run(scene_from_dict(data)).summary["auto_epsilon"]
    assert (lower["between"], upper["between"]) == (["body0", "wall"], ["body1", "wall"])
    light, heavy = (10.0 * density * np.pi * RADIUS**2 for density in (2.0, 4.0))
    alone = heavy * (1.35 - RANGE)
    for row, weight, energy, height in (
        (upper, heavy, alone, 1.35),
        (lower, light + heavy, alone + light * (0.75 - RANGE), 0.75),
    ):
        work = weight * (RANGE - SMALLEST)
        assert row["impact_energy"] == pytest.approx(energy)
        assert row["weight_work"] == pytest.approx(work)
        assert row["smallest_gap"] == SMALLEST
        assert row["impact_speed"] == pytest.approx(np.sqrt(20.0 * (height - RANGE)))
        assert row["epsilon"] == pytest.approx((RANGE - SMALLEST) ** 3 / 3 / (energy + work))


def test_the_summary_is_silent_where_the_scene_gives_numbers() -> None:
    drop = scene("normal", 2, 10.0, ball(1.0), epsilon=1e-3)
    data = drop.to_dict() | {"time": {"end": 1e-3, "step": 1e-3}, "output": {"every": 1e-3}}
    assert rigidfluid.run(scene_from_dict(data)).summary["auto_epsilon"] == []


@pytest.mark.parametrize("dimension", DIMENSIONS)
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("densities", [(2.0, 2.0, 2.0), (2.0, 200.0, 200.0), (200.0, 2.0, 2.0)])
def test_a_stack_that_comes_down_keeps_its_smallest_gap(law: str, densities: Sequence[float], dimension: int) -> None:
    stack = [ball(RADIUS + START + i * (2 * RADIUS + START), density=density) for i, density in enumerate(densities)]
    assert smallest_gap(scene(law, dimension, 10.0, *stack), 0.0, 10.0) >= 0.98 * SMALLEST
