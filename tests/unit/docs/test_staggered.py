"""Flow and disks that are solved in turn: where they agree with one system, where they cannot, and their contacts."""

from __future__ import annotations

import numpy as np
import pytest
from pages._staggered import (
    EPSILON,
    RADIUS,
    RANGE,
    SIDE,
    Disk,
    NotSettledError,
    Staggered,
    contact_energy,
    disk_scene,
    landed,
)

from rigidfluid.api import Simulation

STEP, STEPS = 1e-3, 6


def moved(density: float, most: int) -> Staggered:
    run = Staggered([Disk(density)], step=STEP, end=STEPS * STEP, most=most)
    for _ in range(STEPS):
        run.step()
    return run


@pytest.fixture(scope="module")
def light() -> Simulation:
    run = Simulation(disk_scene([Disk(0.5)], free=True, step=STEP, end=STEPS * STEP))
    run.go()
    return run


def test_iterated_coupling_comes_to_the_velocity_of_one_system(light: Simulation) -> None:
    """But for the first step, that rigidfluid takes twice."""
    turns, velocity = moved(0.5, most=50), light.bodies["disk0"].velocity
    assert turns.run.bodies["disk0"].velocity == pytest.approx(velocity, rel=5e-3, abs=2e-3)
    assert 2 * STEPS <= turns.solves <= 5 * STEPS
    assert abs(turns.created) < 0.02


def test_explicit_coupling_of_a_light_disk_multiplies_its_errors(light: Simulation) -> None:
    velocity = moved(0.5, most=1).run.history.bodies["vy"]
    changes = np.diff(velocity)[1:]
    assert np.all(changes[1:] * changes[:-1] < 0.0)
    assert np.all(np.abs(changes[1:]) > 2.0 * np.abs(changes[:-1]))
    assert np.abs(velocity).max() > 10.0 * light.bodies["disk0"].velocity[1]


def test_explicit_coupling_of_a_heavy_disk_holds() -> None:
    turns = moved(10.0, most=1)
    assert turns.solves == STEPS
    assert abs(turns.created) < 0.1


def test_flow_and_disks_that_do_not_agree_are_told() -> None:
    with pytest.raises(NotSettledError, match="residual"):
        moved(0.1, most=2)


def test_contacts_take_and_give_no_energy() -> None:
    """A disk that falls onto the floor without a fluid, in steps as long as the impact."""
    mass, height, velocity = 0.3, RADIUS + 1.2 * RANGE, -8.0
    start, lowest = 0.5 * mass * velocity**2 + contact_energy(height), height
    for _ in range(30):
        after = landed(velocity, velocity, height, 1e-3, mass)
        height += 0.5e-3 * (velocity + after)
        velocity, lowest = after, min(lowest, height)
        assert 0.5 * mass * velocity**2 + contact_energy(height) == pytest.approx(start, rel=1e-9)
    assert lowest < RADIUS + 0.5 * RANGE
    assert velocity > 0.0


@pytest.mark.parametrize("height", [RADIUS + 0.4 * RANGE, SIDE - RADIUS - 0.4 * RANGE])
def test_contacts_are_those_of_the_library(height: float) -> None:
    run = Simulation(disk_scene([Disk(1.0, y=height)], free=True, step=1e-5, end=1e-5))
    ledger = run.history.energy
    assert contact_energy(height) == pytest.approx(float(ledger["contact"][0]), rel=1e-9)
    assert contact_energy(height) == pytest.approx((0.6 * RANGE) ** 3 / (3.0 * EPSILON))
