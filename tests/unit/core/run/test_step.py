"""The books of a step: all work that is done, and all that is lost or stored, each in its entry."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scenes import dry_tables, wet_tables

import rigidfluid
from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.output.history import History

BALL = {"name": "ball", "type": "sphere", "radius": 0.1, "density": 2.0, "position": [0.5, 0.4]}
OTHER = BALL | {"name": "other", "position": [0.5, 0.7]}
HINGE = {"name": "knee", "type": "hinge", "between": ["ball", "other"], "at": [0.5, 0.55]}
MASS = 2.0 * np.pi * 0.1**2
CREEPING = {"density": 1.0, "viscosity": 1.0, "model": "stokes"}


def dry(*bodies: dict[str, Any], **tables: Any) -> History:
    return rigidfluid.run(scene_from_dict(dry_tables(*bodies, **tables)))


def left_over(history: History) -> float:
    """Greatest residual over the energy put in."""
    return float(np.abs(history.energy["residual"]).max() / history.summary["energy"]["put_in"])


def creeping(*bodies: dict[str, Any], joint: dict[str, Any], end: float = 0.1, **tables: Any) -> History:
    """Bodies without mass in a fluid without inertia."""
    light = [body | {"density": 1e-6} for body in bodies]
    return rigidfluid.run(
        scene_from_dict(wet_tables(*light, fluid=CREEPING, joint=[joint], end=end, output={"every": 0.01}, **tables))
    )


def test_a_drive_in_a_fluid_gives_what_the_fluid_takes() -> None:
    drive = {"piecewise": [[0.0, 0.0], [1.0, 1.5], [2.0, 0.0]]}
    energy = creeping(BALL, OTHER, joint=HINGE | {"drive": drive}).energy
    assert energy["dissipation"][-1] > 0.01
    assert energy["control"][-1] == pytest.approx(energy["dissipation"][-1], rel=1e-4)


def test_a_damper_in_a_fluid_takes_its_coefficient_times_the_square_of_the_rate() -> None:
    history = creeping(BALL | {"prescribed": {"angular_velocity": 2.0}}, OTHER, joint=HINGE | {"damping": 0.7})
    energy, rate = history.energy, np.asarray(history.joints["rate"][1:])
    assert np.ptp(rate) < 0.05 * np.abs(rate).min()
    assert energy["contact_loss"][-1] == pytest.approx(0.7 * float(np.mean(rate**2)) * 0.1, rel=0.01)
    given = energy["dissipation"][-1] + energy["contact_loss"][-1]
    assert energy["control"][-1] == pytest.approx(given, rel=1e-3)


def test_what_turns_a_body_in_a_fluid_works_on_the_fluid_and_on_a_spring() -> None:
    turning = BALL | {"prescribed": {"angular_velocity": 2.0}}
    history = creeping(turning, OTHER, joint=HINGE | {"stiffness": 3.0})
    energy = history.energy
    stored = energy["contact"][-1]
    assert stored > 0.01
    assert energy["control"][-1] == pytest.approx(energy["dissipation"][-1] + stored, rel=2e-3)
    assert energy["control"][-1] > 0.05


@pytest.mark.parametrize("amplitude", [0.05])
def test_what_swings_in_a_fluid_without_inertia_is_in_the_books_to_second_order(amplitude: float) -> None:
    residuals = []
    for step in (0.02, 0.01):
        swinging = BALL | {"prescribed": {"amplitude": [amplitude, 0.0], "frequency": 1.0}}
        tables = wet_tables(swinging, fluid=CREEPING, end=0.2, step=step)
        residuals.append(left_over(rigidfluid.run(scene_from_dict(tables))))
    assert residuals[1] < 0.35 * residuals[0] < 0.02


def test_a_fall_on_a_dashpot_gives_its_weights_work_and_takes_a_known_part() -> None:
    """The ball comes back with .6 of its speed at the range, where it has fallen by .2."""
    law = {"law": "spring-dashpot", "range": 0.1, "stiffness": 3000.0, "restitution": 0.6}
    history = dry(BALL, fluid={"gravity": [0.0, -1.0]}, contact=law, step=4e-3, end=0.7, output={"every": 0.02})
    energy, height = history.energy, history.bodies["y"]
    fallen = MASS * (0.4 - np.asarray(height))
    np.testing.assert_allclose(energy["gravity"], fallen, atol=1e-12)
    assert energy["contact_loss"][-1] == pytest.approx((1.0 - 0.6**2) * MASS * 0.2, rel=0.02)
    assert left_over(history) < 2e-3
    assert max(energy["contact"]) > 0.3 * MASS * 0.2


def test_a_spring_stores_what_it_takes_and_a_pendulum_keeps_what_it_has() -> None:
    hung = BALL | {"velocity": [0.3, 0.0], "spring": {"stiffness": [20.0, 20.0]}}
    history = dry(hung, fluid={"gravity": [0.0, -1.0]}, step=5e-3, end=0.3, output={"every": 0.02})
    assert left_over(history) < 3e-3
    assert max(history.energy["contact"]) > 0.5 * MASS * 0.3**2 * 0.5
    swinging = HINGE | {"between": ["ball"], "at": [0.3, 0.4]}
    history = dry(BALL, joint=[swinging], fluid={"gravity": [0.0, -1.0]}, step=5e-3, end=0.3, output={"every": 0.1})
    speed = np.hypot(history.bodies["vx"], history.bodies["vy"])[-1]
    spin, sunk = speed / 0.2, 0.4 - history.bodies["y"][-1]
    assert 0.5 * MASS * (speed**2 + 0.5 * (0.1 * spin) ** 2) == pytest.approx(MASS * sunk, rel=1e-4)
    assert history.energy["kinetic"][-1] == pytest.approx(MASS * sunk, rel=1e-4)
    assert left_over(history) < 3e-3


def test_what_is_driven_has_no_energy_and_weighs_nothing_but_works_on_what_it_pushes() -> None:
    driven = BALL | {"prescribed": {"velocity": [0.0, 0.5], "angular_velocity": 3.0}}
    law = {"law": "normal", "range": 0.1, "epsilon": 1e-4}
    history = dry(driven, OTHER, fluid={"gravity": [0.0, -1.0]}, contact=law, step=4e-3, end=0.2)
    risen, energy = history.bodies["y"][-1] - 0.7, history.energy
    assert energy["gravity"][-1] == pytest.approx(-MASS * risen)
    assert energy["kinetic"][-1] == pytest.approx(0.5 * MASS * history.bodies["vy"][-1] ** 2)
    assert energy["control"][-1] > 0.1 * MASS
    assert left_over(history) < 3e-3
