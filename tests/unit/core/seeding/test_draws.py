"""Random shapes, sizes, orientations and velocities of swarms have the distributions that are asked for."""

from __future__ import annotations

import numpy as np
import pytest
from swarms import BALL, DISK, ELLIPSE, ELLIPSOID, radii, seeded, start

from rigidfluid.core.mechanics.rigid import angle_between, rotation_matrices
from rigidfluid.core.scene.swarm_tables import LogNormalSizes, NormalSizes, TableSizes, UniformSizes
from rigidfluid.core.seeding.draws import Draws

MANY = 40_000


def test_uniform_sizes_have_the_mean_and_deviation_of_their_ends() -> None:
    found = Draws(1, 0).factors(MANY, UniformSizes(distribution="uniform", least=0.5, greatest=2.0))
    assert found.min() >= 0.5
    assert found.max() <= 2.0
    np.testing.assert_allclose([found.mean(), found.std()], [1.25, 1.5 / np.sqrt(12.0)], rtol=0.01)


def test_normal_sizes_are_cut_off_at_both_ends() -> None:
    wide = NormalSizes(distribution="normal", mean=1.0, deviation=0.1, least=0.1, greatest=2.0)
    found = Draws(1, 0).factors(MANY, wide)
    np.testing.assert_allclose([found.mean(), found.std()], [1.0, 0.1], rtol=0.01)
    cut = NormalSizes(distribution="normal", mean=1.0, deviation=1.0, least=0.9, greatest=1.2)
    found = Draws(1, 0).factors(MANY, cut)
    assert (found.min() >= 0.9) & (found.max() <= 1.2)
    np.testing.assert_allclose(found.mean(), 1.0496, atol=0.001)  # 1 + (φ(-.1) - φ(.2))/(Φ(.2) - Φ(-.1))


def test_logarithms_of_log_normal_sizes_are_normal() -> None:
    table = LogNormalSizes(distribution="log-normal", median=2.0, deviation=0.3, least=0.01, greatest=100.0)
    found = np.log(Draws(2, 0).factors(MANY, table))
    np.testing.assert_allclose([found.mean(), found.std()], [np.log(2.0), 0.3], rtol=0.01)


def test_sizes_of_a_table_come_as_often_as_their_shares_say() -> None:
    found = Draws(3, 0).factors(MANY, TableSizes(distribution="table", rows=((0.5, 3.0), (1.0, 0.0), (2.0, 1.0))))
    assert set(found) == {0.5, 2.0}
    np.testing.assert_allclose(np.mean(found == 0.5), 0.75, atol=0.01)


def test_shapes_come_as_often_as_their_weights_say() -> None:
    scene = seeded(2, DISK | {"radius": 0.005, "weight": 3.0}, ELLIPSE | {"semi_axes": [0.008, 0.004]}, number=400)
    disks = sum(body.type == "sphere" for body in scene.body)
    assert abs(disks - 300) < 3.0 * np.sqrt(400 * 0.75 * 0.25)


def test_orientations_are_equally_likely() -> None:
    turned = rotation_matrices(Draws(4, 0).orientations(MANY, 3))
    np.testing.assert_allclose(turned.mean(axis=0), np.zeros((3, 3)), atol=0.01)
    np.testing.assert_allclose(np.mean(turned**2, axis=0), np.full((3, 3), 1.0 / 3.0), atol=0.01)
    angle = Draws(4, 0).orientations(MANY, 2)[:, 0]
    np.testing.assert_allclose(np.histogram(angle, 8, (0.0, 2.0 * np.pi))[0] / MANY, 0.125, atol=0.006)


def test_bodies_tilt_from_the_orientation_that_is_given() -> None:
    scene = seeded(2, ELLIPSE | {"semi_axes": [0.01, 0.005]}, number=300, angle=1.0, tilt=0.2)
    angle = start(scene).orientation[:, 0]
    np.testing.assert_allclose([angle.mean(), angle.std()], [1.0, 0.2], atol=0.03)
    still = seeded(3, ELLIPSOID, number=3, orientation=[2.0, 0.0, 0.0, 0.0])
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (3, 1))
    np.testing.assert_allclose(angle_between(start(still).orientation, upright), 0.0, atol=1e-12)


def test_velocities_have_a_mean_and_a_random_part() -> None:
    scene = seeded(
        2,
        DISK | {"radius": 0.005},
        number=400,
        velocity=[1.0, 0.0],
        velocity_deviation=0.5,
        angular_velocity_deviation=2.0,
    )
    velocity = np.array([body.velocity for body in scene.body])
    np.testing.assert_allclose(velocity.mean(axis=0), [1.0, 0.0], atol=0.08)
    np.testing.assert_allclose(velocity.std(axis=0), [0.5, 0.5], rtol=0.1)
    np.testing.assert_allclose(np.std([body.angular_velocity for body in scene.body]), 2.0, rtol=0.1)


@pytest.mark.parametrize("number", [3, 12])
def test_more_bodies_leave_the_sizes_of_the_first_as_they_are(number: int) -> None:
    size = {"distribution": "uniform", "least": 0.2, "greatest": 0.4}
    few, many = (radii(seeded(3, BALL, number=count, size=size)) for count in (number, 20))
    np.testing.assert_array_equal(few, many[:number])
