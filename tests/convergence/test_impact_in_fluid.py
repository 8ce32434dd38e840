"""A disk thrown at a floor in a fluid, by a law far stiffer than a step resolves, 20 ms after its impact."""

from __future__ import annotations

import numpy as np
import pytest
from extreme_wet import floor_hit

from rigidfluid.core.run.simulation import Simulation

pytestmark = pytest.mark.long

MOMENT = 0.032


def rebound(step: float) -> float:
    """The speed at which the disk comes back [length/time]."""
    run = Simulation(floor_hit(step, "substeps"), None, False)
    run.go(until=MOMENT)
    return float(run.state.twist.velocity[0, 1])


def test_steps_that_are_shortened_in_the_impact_are_near_each_other() -> None:
    coarse, fine = rebound(4e-3), rebound(1e-3)
    assert coarse > 0.0
    assert fine == pytest.approx(coarse, rel=0.02)


@pytest.mark.validation
def test_shorter_ones_converge_to_first_order_and_better() -> None:
    changes = np.abs(np.diff([rebound(2.5e-4 / 2.0**halvings) for halvings in range(4)]))
    assert np.all(changes[:-1] / changes[1:] > 2.0)
