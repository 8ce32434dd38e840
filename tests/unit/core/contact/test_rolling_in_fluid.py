"""Rolling and twisting friction in a fluid: its couples slow the body, and the account of energy closes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History

RADIUS, DENSITY, GRAVITY, RANGE, SPEED, SPIN = 0.125, 4.0, 10.0, 0.02, 0.5, 10.0
ROLLING, TWISTING, END = 0.1, 0.05, 0.024
ALLOWED = 0.005
STEPPINGS = "substeps", "implicit"
LAWS = {
    "spring-dashpot": {"stiffness": {2: 200.0, 3: 40.0}, "tangential_stiffness": {2: 150.0, 3: 30.0}},
    "normal": {"epsilon": {2: 4e-5, 3: 2e-4}},
}


@cache
def rolled(
    dimension: int, stepping: str = "substeps", rubbing: bool = True, law: str = "spring-dashpot", end: float = END
) -> History:
    """A ball, or a disk, that rolls on the floor it presses with its weight; the ball spins about the normal too."""
    axes, speed = [0.0] * (dimension - 1), SPEED * np.eye(dimension)[0]
    spin = -SPEED / RADIUS if dimension == 2 else [0.0, SPEED / RADIUS, SPIN]
    ball = {
        "type": "sphere",
        "radius": RADIUS,
        "density": DENSITY,
        "velocity": speed.tolist(),
        "angular_velocity": spin,
    }
    place = [0.3] if dimension == 2 else [0.3, 0.25]
    coefficients = {"rolling_friction": ROLLING if rubbing else 0.0, "twisting_friction": TWISTING if rubbing else 0.0}
    keys = {key: values[dimension] for key, values in LAWS[law].items()}
    return rigidfluid.run(
        scene_from_dict(
            {
                "scene": {"name": "wet_rolling", "dimension": dimension},
                "fluid": {"density": 1.0, "viscosity": 0.02, "gravity": [*axes, -GRAVITY]},
                "domain": {"lower": [0.0] * dimension, "upper": [0.8, *[0.5] * (dimension - 1)]},
                "body": [ball | {"position": [*place, RADIUS + 0.0127]}],
                "contact": {
                    **{"law": law, "range": RANGE, "restitution": 0.3, "friction": 0.5, "stepping": stepping},
                    **keys,
                    **coefficients,
                },
                "mesh": {"size": 0.2, "size_body": 0.075, "refinements": 0},
                "time": {"end": end, "step": 4e-3},
                "output": {"every": end},
            }
        )
    )


def assert_keeps_its_account(history: History) -> None:
    """Of what was put in, after the first step, which sets the fluid in motion at once."""
    energy = history.energy
    put_in = energy["kinetic"][0] + energy["gravity"].max()
    assert np.abs(energy["residual"][1:] - energy["residual"][1]).max() < ALLOWED * put_in
    assert history.summary["energy"]["largest_creation"] < ALLOWED
    assert energy["contact_loss"][-1] > 0.0


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("stepping", ["substeps", pytest.param("implicit", marks=pytest.mark.long)])
def test_a_disk_is_slowed_and_no_energy_is_made(stepping: str, law: str) -> None:
    """Its torque is that of the force along the floor and μ_r R F_n."""
    slowed, free = rolled(2, stepping, law=law), rolled(2, stepping, False, law)
    for history in (slowed, free):
        assert_keeps_its_account(history)
    assert slowed.energy["contact_loss"][-1] > 3.0 * free.energy["contact_loss"][-1]
    assert abs(slowed.bodies["w"][-1]) < abs(free.bodies["w"][-1])
    for history, coefficient in ((slowed, ROLLING), (free, 0.0)):
        body = {name: column[-1] for name, column in history.bodies.items()}
        arm = RADIUS + 0.5 * body["gap"]
        couple = coefficient * RADIUS * body["cfy"]
        assert body["ct"] - arm * body["cfx"] == pytest.approx(couple, rel=0.02, abs=1e-4)


def test_implicit_steps_take_as_much_as_substeps() -> None:
    one, other = (rolled(2, stepping) for stepping in STEPPINGS)
    for name in ("vx", "w"):
        assert one.bodies[name][-1] == pytest.approx(other.bodies[name][-1], rel=2e-3)
    assert one.energy["contact_loss"][-1] == pytest.approx(other.energy["contact_loss"][-1], rel=0.05)


@pytest.mark.parametrize("stepping", ["substeps", pytest.param("implicit", marks=pytest.mark.long)])
def test_couples_reach_a_ball_in_3d(stepping: str) -> None:
    history = rolled(3, stepping, end=0.012)
    assert_keeps_its_account(history)
    body = {name: column[-1] for name, column in history.bodies.items()}
    assert body["ctz"] == pytest.approx(-TWISTING * RADIUS * body["cfz"], rel=1e-3)
    rolling = body["cty"] + (RADIUS + 0.5 * body["gap"]) * body["cfx"]
    assert rolling == pytest.approx(-ROLLING * RADIUS * body["cfz"], rel=0.01)
