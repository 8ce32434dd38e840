"""A disk thrown at a floor in a fluid, by a law far stiffer than a step resolves, 20 ms after its impact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from extreme_wet import corner_hit, floor_hit

from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

MOMENT = 0.032


def rebound(step: float) -> float:
    """The speed at which the disk comes back [length/time]."""
    run = Simulation(floor_hit(step, "substeps"), None, False)
    run.go(until=MOMENT)
    return float(run.state.twist.velocity[0, 1])


def spin(step: float) -> float:
    """The rate at which a square turns that has hit the floor with a corner [1/time]."""
    run = Simulation(corner_hit(step, "substeps"), None, False)
    run.go(until=MOMENT)
    return float(run.state.twist.angular_velocity[0, 0])


@pytest.mark.parametrize(("figure", "allowed"), [(rebound, 0.01), pytest.param(spin, 0.002, marks=pytest.mark.nightly)])
def test_steps_that_are_shortened_in_the_impact_are_near_each_other(
    figure: Callable[[float], float], allowed: float
) -> None:
    coarse, fine = figure(4e-3), figure(1e-3)
    assert abs(coarse) > 1.0
    assert fine == pytest.approx(coarse, rel=allowed)


@pytest.mark.validation
def test_shorter_ones_converge_to_first_order_and_better() -> None:
    changes = np.abs(np.diff([rebound(1.25e-4 / 2.0**halvings) for halvings in range(4)]))
    assert np.all(changes[:-1] / changes[1:] > 2.0)
