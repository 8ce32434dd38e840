"""Dry dynamics between contacts: prescribed bodies follow their motion, constant torques turn free ones."""

from __future__ import annotations

import numpy as np
import pytest
from linked_bodies import masses, placed, split

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.mechanics.dynamics import DryDynamics, Turning
from rigidfluid.core.mechanics.time_scheme import momentum
from rigidfluid.core.mechanics.wrenches import flat, nothing

DIMENSIONS = pytest.mark.parametrize("dimension", [2, 3])


@DIMENSIONS
def test_a_prescribed_body_goes_as_it_is_told_and_takes_no_push(dimension: int) -> None:
    """By the velocity in mid-step along the way, and that of the time at its end; the other one is free."""
    pose, rate = placed(2, dimension), np.random.default_rng(1).normal(size=(2, 3 if dimension == 2 else 6))
    held = np.array([True, False])

    def given(time: float) -> FloatArray:
        return np.asarray((1.0 + 2.0 * time) * rate)

    own = *masses(2, dimension), np.zeros((2, dimension)), held
    body = DryDynamics(pose, split(rate, dimension), *own, given)
    body.apply_impulse(np.ones_like(rate))
    body.drift(0.1)
    np.testing.assert_allclose(body.pose.position[0] - pose.position[0], 0.11 * rate[0, :dimension])
    np.testing.assert_allclose(flat(body.twist)[0], 1.2 * rate[0], atol=1e-12)
    assert not body.inverse_inertia[0].any()
    assert not body.inverse_mass[0].any()
    change = momentum(*masses(2, dimension), pose, split(rate, dimension))[1]
    found = momentum(*masses(2, dimension), body.pose, body.twist)[1]
    np.testing.assert_allclose(found - change, 1.0)
    fastest = np.linalg.norm(2.0 * rate[0, :dimension])
    assert body.max_acceleration(0.1)[0] == pytest.approx(fastest)


@DIMENSIONS
def test_a_constant_torque_turns_a_body_and_bounds_the_speed_of_its_surface(dimension: int) -> None:
    pose, free = placed(1, dimension), np.zeros(1, dtype=bool)
    torque: FloatArray = np.random.default_rng(2).normal(size=(1, 1 if dimension == 2 else 3))
    mass, inertia = masses(1, dimension)
    rest = split(np.zeros((1, dimension + torque.shape[1])), dimension)
    turning = Turning(torque, np.array([0.7]))
    weight = np.full((1, dimension), -3.0)
    body = DryDynamics(pose, rest, mass, inertia, weight, free, lambda _: np.zeros(0), turning)
    told = body.max_acceleration(0.1)[0]
    body.kick(nothing(pose), 0.1)
    gained = momentum(mass, inertia, pose, body.twist)
    np.testing.assert_allclose(gained, 0.1 * np.concatenate([weight, torque], axis=1), atol=1e-14)
    found = np.linalg.norm(body.twist.velocity) + 0.7 * np.linalg.norm(body.twist.angular_velocity)
    assert found <= 0.1 * told * (1.0 + 1e-12) < 2.0 * found
