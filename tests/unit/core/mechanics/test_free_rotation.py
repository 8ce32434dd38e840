"""Torque-free rotation against Jacobi's elliptic functions, over one period and over a thousand."""

from dataclasses import replace

import numpy as np
import pytest
from scenes import dry_tables
from scipy.special import ellipj, ellipkinc

from rigidfluid.core.case.load import scene_from_dict
from rigidfluid.core.mechanics.free_rotation import SMALL, _midpoint, rotate_freely, turn_balls
from rigidfluid.core.mechanics.rigid import rotate, rotation_matrices
from rigidfluid.core.mechanics.single_bodies import SingleBodies
from rigidfluid.core.run.simulation import Simulation
from rigidfluid.errors import StepRejected

INERTIA = np.array([1.0, 2.0, 3.0])
START = np.array([0.3, 1.0, 1.5])
PERIOD = 4.058734421
UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]])


def spin(orientation):
    """Angular velocity in the body's frame."""
    return rotation_matrices(orientation)[0].T @ (INERTIA * START) / INERTIA


def exact_spin(time):
    """Jacobi's solution through START, for energy times largest moment below momentum squared."""
    energy, square = INERTIA @ START**2, (INERTIA * START) @ (INERTIA * START)
    i1, i2, i3 = INERTIA
    low, high = energy * i3 - square, square - energy * i1
    amplitude = np.sqrt([low / (i1 * (i3 - i1)), low / (i2 * (i3 - i2)), high / (i3 * (i3 - i1))])
    rate = np.sqrt((i3 - i2) * high / (i1 * i2 * i3))
    parameter = (i2 - i1) * low / ((i3 - i2) * high)
    assert parameter == pytest.approx(0.140645, abs=1e-6)
    begin = ellipkinc(np.arcsin(START[1] / amplitude[1]), parameter)
    sn, cn, dn, _ = ellipj(begin + rate * time, parameter)
    return amplitude * [cn, sn, dn]


@pytest.mark.parametrize("square", [0.0, 1e-12, 0.999 * SMALL, 1.001 * SMALL, 4.0])
def test_balls_turn_by_their_rotation_vectors(square):
    """By series and by sine and cosine alike, on either side of where one takes over."""
    axis, moment = np.array([[0.48, 0.6, -0.64]]), 0.7
    start = rotate(UPRIGHT, np.array([[0.3, -0.2, 0.9]]))
    turned = turn_balls(start, 2.0 * np.sqrt(square) * moment * axis, np.array([1.0 / moment]), 1.0)
    np.testing.assert_allclose(turned, rotate(start, 2.0 * np.sqrt(square) * axis), rtol=0, atol=4e-16)


@pytest.mark.parametrize("time", [0.1, 1.0, 3.0, -2.0])
def test_it_follows_jacobi(time):
    turned = rotate_freely(UPRIGHT, (INERTIA * START)[None], np.diag(INERTIA)[None], time)
    np.testing.assert_allclose(spin(turned), exact_spin(time), atol=1e-7)


def test_the_period_is_the_known_one():
    turned = rotate_freely(UPRIGHT, (INERTIA * START)[None], np.diag(INERTIA)[None], PERIOD)
    np.testing.assert_allclose(spin(turned), START, atol=1e-6)


@pytest.mark.long
def test_the_midpoint_rule_keeps_the_energy_over_a_large_turn():
    """Only where its equation is solved, which Newton's method does for turns that are no small change."""
    turned = UPRIGHT.copy()
    _midpoint(turned[0], INERTIA * START, np.diag(1.0 / INERTIA), 1.5)
    assert np.linalg.norm(spin(turned) - START) > 0.5
    assert INERTIA @ spin(turned) ** 2 == pytest.approx(INERTIA @ START**2, rel=1e-12)


def test_one_long_turn_is_as_good_as_many_short_ones():
    momentum, inertia = (INERTIA * START)[None], np.diag(INERTIA)[None]
    many = UPRIGHT
    for _ in range(50):
        many = rotate_freely(many, momentum, inertia, 0.1)
    np.testing.assert_allclose(rotate_freely(UPRIGHT, momentum, inertia, 5.0), many, atol=1e-7)


def test_round_and_planar_bodies_turn_evenly():
    ball = rotate_freely(UPRIGHT, np.array([[0.0, 0.0, 2.0]]), 4.0 * np.eye(3)[None], 3.0)
    np.testing.assert_allclose(ball, [[np.cos(0.75), 0.0, 0.0, np.sin(0.75)]], atol=1e-15)
    disk = rotate_freely(np.array([[1.0]]), np.array([[6.0]]), np.array([[[2.0]]]), 10.0)
    np.testing.assert_allclose(disk, [[31.0]])


@pytest.mark.long
def test_a_thousand_periods_keep_energy_and_momentum():
    """Through the loop and its differences of momentum, at four steps a period."""
    body = {"type": "ellipsoid", "semi_axes": [0.3, 0.2, 0.1], "density": 1.0, "position": [0.5, 0.5, 0.5]}
    scene = scene_from_dict(dry_tables(body | {"angular_velocity": START.tolist()}, end=1000 * PERIOD, step=PERIOD / 4))
    run = Simulation(scene, None, False)
    system, inertia = run.system, np.diag(INERTIA)[None]
    motions = SingleBodies(system.mass, inertia, system.prescribed, system.pose, system.twist)
    run.stepper.system = replace(system, inertia=inertia, motions=motions)
    run.go()
    history, momentum = run.history.bodies, INERTIA * START
    orientation = np.column_stack([history[name] for name in ("qw", "qx", "qy", "qz")])
    rotation = rotation_matrices(orientation)
    local = np.einsum("nji,nj->ni", rotation, np.column_stack([history[name] for name in ("wx", "wy", "wz")]))
    energy = 0.5 * local**2 @ INERTIA
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
    kept = np.einsum("nij,nj->ni", rotation, INERTIA * local)
    np.testing.assert_allclose(kept, np.broadcast_to(momentum, kept.shape), atol=1e-9 * np.linalg.norm(momentum))
    assert len(energy) == 4_001


def test_round_bodies_turn_by_their_constant_spin():
    random = np.random.default_rng(0)
    orientation = random.normal(size=(20, 4))
    orientation /= np.linalg.norm(orientation, axis=1, keepdims=True)
    spin, moment = random.normal(size=(20, 3)), random.uniform(0.5, 2.0, 20)
    spin[3] = 0.0
    turned = rotate_freely(orientation, moment[:, None] * spin, moment[:, None, None] * np.eye(3), 0.7)
    np.testing.assert_allclose(turned, rotate(orientation, 0.7 * spin), rtol=0, atol=1e-15)
    np.testing.assert_array_equal(turned[3], orientation[3])


def test_a_spin_of_too_many_turns_is_refused():
    """Each turn takes its time, and nothing can interrupt them."""
    momentum, inertia = np.tile(INERTIA * START, (2, 1)), np.tile(np.diag(INERTIA), (2, 1, 1))
    momentum[1] *= 1e9
    with pytest.raises(
        StepRejected, match=r"body\.1\.angular_velocity: found .* rad in a step; allowed is at most 1000"
    ):
        rotate_freely(np.tile(UPRIGHT, (2, 1)), momentum, inertia, 1.0)
