"""Mass and resistance of bodies in a fluid, from their inviscid and viscous impulse responses."""

import numpy as np
import pytest

from rigidfluid.core.geometry.arrays import FloatArray
from rigidfluid.core.model.reduced_model import Evaluation, ReducedModel, load_within, mean_load, reduced_model

D0, COUNT = 750.0, 5


def positive(seed: int) -> FloatArray:
    """A symmetric positive matrix."""
    root = np.random.default_rng(seed).normal(size=(COUNT, COUNT))
    return root @ root.T + 0.5 * np.eye(COUNT)


def made(inviscid: FloatArray, viscous: FloatArray, shared: bool = False) -> ReducedModel:
    return reduced_model(np.arange(COUNT), inviscid, viscous, D0, Evaluation(*np.ones((2, COUNT))), shared)


MASS, FRICTION = positive(1), 400.0 * positive(2)
INVISCID, VISCOUS = np.linalg.inv(MASS), D0 * np.linalg.inv(D0 * MASS + FRICTION)
MODEL = made(INVISCID, VISCOUS)


def test_modes_are_those_of_mass_and_friction():
    np.testing.assert_allclose(MODEL.modes.T @ MASS @ MODEL.modes, np.eye(COUNT), atol=1e-12)
    friction = MODEL.modes.T @ FRICTION @ MODEL.modes
    np.testing.assert_allclose(friction, np.diag(MODEL.decay), atol=1e-10 * MODEL.decay.max())
    np.testing.assert_allclose(MODEL.inverse_mass, INVISCID, rtol=1e-12, atol=1e-13)


def test_mass_and_friction_are_found_again():
    velocity = np.arange(1.0, COUNT + 1.0)
    np.testing.assert_allclose(MODEL.mass_times(velocity), MASS @ velocity, rtol=1e-11)
    np.testing.assert_allclose(MODEL.friction_times(velocity), FRICTION @ velocity, rtol=1e-10)


def test_the_response_is_that_of_the_step():
    np.testing.assert_allclose(MODEL.response(D0, np.eye(COUNT)), VISCOUS, rtol=1e-11, atol=1e-13)
    impulse = np.array([1.0, -2.0, 0.5, 0.0, 3.0])
    np.testing.assert_allclose(MODEL.response(D0, impulse), VISCOUS @ impulse, rtol=1e-11, atol=1e-13)


def test_the_response_in_another_step_has_the_same_mass_and_friction():
    expected = 3.0 * D0 * np.linalg.inv(3.0 * D0 * MASS + FRICTION)
    np.testing.assert_allclose(MODEL.response(3.0 * D0, np.eye(COUNT)), expected, rtol=1e-10, atol=1e-13)


@pytest.mark.parametrize("shared", [False, True])
def test_friction_is_never_negative(shared):
    skew = np.triu(np.ones((COUNT, COUNT)), 1) - np.tril(np.ones((COUNT, COUNT)), -1)
    for viscous in (VISCOUS + 0.05 * skew, 1.3 * INVISCID, INVISCID + 0.1 * positive(7)):
        model = made(INVISCID, viscous, shared)
        assert model.decay.min() >= 0.0
        assert np.isfinite(model.decay).all()
    np.testing.assert_array_equal(made(INVISCID, 1.3 * INVISCID).decay, 0.0)


def test_the_unsymmetric_part_of_a_response_is_dropped():
    skew = np.triu(np.ones((COUNT, COUNT)), 1) - np.tril(np.ones((COUNT, COUNT)), -1)
    np.testing.assert_allclose(made(INVISCID, VISCOUS + 0.05 * skew).decay, MODEL.decay, rtol=1e-8)


def test_the_load_does_not_depend_on_the_impulse_of_its_step():
    rng = np.random.default_rng(3)
    freely, now, past, before = rng.normal(size=(4, COUNT))
    derivative = np.array([D0, -1000.0, 250.0])
    loads = [
        load_within(MODEL, derivative, (freely + VISCOUS @ impulse, now, past), (impulse, before))
        for impulse in (np.zeros(COUNT), 10.0 * rng.normal(size=COUNT))
    ]
    np.testing.assert_allclose(loads[1], loads[0], atol=1e-10 * np.abs(loads[0]).max())


def test_the_load_is_that_of_the_scheme():
    """Solve d₀MUⁿ⁺¹ + d₁MUⁿ + d₂MUⁿ⁻¹ + R (Uⁿ⁺¹ - Uⁿ) = Φ + d₀Jⁿ⁺¹ - d₂Jⁿ, and read Φ from it."""
    load, now, past, impulse, before = np.random.default_rng(4).normal(size=(5, COUNT))
    d0, d1, d2 = derivative = np.array([D0, -1000.0, 250.0])
    right = load + d0 * impulse - d2 * before - MASS @ (d1 * now + d2 * past) + FRICTION @ now
    new = np.linalg.solve(d0 * MASS + FRICTION, right)
    found = load_within(MODEL, derivative, (new, now, past), (impulse, before))
    np.testing.assert_allclose(found, load, atol=1e-9 * np.abs(MASS @ now).max() * D0)


def test_the_mean_load_of_a_constant_force_and_drag():
    """M dU/dt = G - R U + contacts by the trapezoidal rule: in the next step Φ = G - R Uⁿ."""
    force, past, impulse = np.random.default_rng(5).normal(size=(3, COUNT))
    step = 2e-3
    right = MASS @ past + impulse + step * (force - 0.5 * FRICTION @ past)
    now = np.linalg.solve(MASS + 0.5 * step * FRICTION, right)
    found = mean_load(MODEL, now - past, impulse, step)
    np.testing.assert_allclose(found, force - FRICTION @ now, atol=1e-10 * np.abs(FRICTION @ now).max())


def test_where_right_sides_are_shared_every_mode_responds():
    """Their errors may make the responses slightly indefinite, and a mode without any response would never move."""
    inviscid, viscous = np.diag([1.0, 1.0, 1.0, 1.0, 1.0]), 0.5 * np.eye(COUNT)
    viscous[:2, :2] = [[0.5, 0.51], [0.51, 0.5]]
    assert np.linalg.eigvalsh(viscous).min() < 0.0
    shared = made(inviscid, viscous, shared=True)
    assert shared.decay.max() == pytest.approx(D0 * (1.0 / 0.05 - 1.0))
    assert made(inviscid, viscous).decay.max() > 1e9 * D0
    inviscid[2:4, 2:4] = [[1.0, 1.02], [1.02, 1.0]]
    assert np.linalg.eigvalsh(made(inviscid, viscous, shared=True).inverse_mass).min() == pytest.approx(0.1)
