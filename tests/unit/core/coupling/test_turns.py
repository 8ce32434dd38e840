"""Energy that a step creates as contacts turn bodies, by the reduced model."""

from __future__ import annotations

import numpy as np
import pytest

from rigidfluid.core.coupling.turns import created_in_turn
from rigidfluid.core.model.reduced_model import Evaluation, ReducedModel

MASS, DECAY, SIZE = 2.0, 3.0, 1e-3


def one_velocity() -> ReducedModel:
    """M dU/dt + R U = F of one velocity, R = DECAY · MASS."""
    none = np.zeros(1)
    modes = np.array([[1.0 / np.sqrt(MASS)]])
    return ReducedModel(np.zeros(1, dtype=np.int64), modes, np.array([DECAY]), Evaluation(none, none), False)


@pytest.mark.parametrize("steps", [16, 64])
def test_an_oscillation_creates_a_known_part_of_what_it_dissipates(steps):
    """(ωΔt)²/6 of the dissipation ∫ R U² dt."""
    velocity = np.sin(2.0 * np.pi * np.arange(steps + 1) / steps)
    model = one_velocity()
    created = sum(created_in_turn(model, change, 0.0, SIZE) for change in np.diff(velocity)[:, None])
    dissipated = DECAY * MASS * SIZE * steps / 2.0
    assert created / dissipated == pytest.approx((2.0 * np.pi / steps) ** 2 / 6.0, rel=0.02)


def test_a_body_thrown_back_within_a_step_creates_nothing():
    """From -U to U in its middle, where friction takes Δt R U²/3; a weaker friction leaves some."""
    speed, friction = 5.0, SIZE * DECAY * MASS * 5.0**2 / 3.0
    change = np.array([2.0 * speed])
    assert created_in_turn(one_velocity(), change, friction, SIZE) == pytest.approx(0.0, abs=1e-12)
    assert created_in_turn(one_velocity(), change, 2.0 * friction, SIZE) == 0.0
    assert created_in_turn(one_velocity(), change, 0.0, SIZE) == pytest.approx(2.0 * friction)
