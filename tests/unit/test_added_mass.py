"""Added mass and inertia against Lamb's values."""

import numpy as np
import pytest
from mesh_tools import ball, ellipsoid

from rigidfluid.core.added_mass import added_inertia, added_mass


def test_of_a_ball_half_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3, dimension=3)
    np.testing.assert_allclose(added_mass(shape), 0.5 * shape.volume * np.eye(3), rtol=1e-12)
    np.testing.assert_array_equal(added_inertia(shape), np.zeros((3, 3)))


def test_of_a_disk_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3)
    np.testing.assert_allclose(added_mass(shape), shape.volume * np.eye(2), rtol=1e-12)
    assert added_inertia(shape)[0, 0] == 0.0


def test_of_an_ellipse():
    shape = ellipsoid(0.3, 0.1)
    np.testing.assert_allclose(added_mass(shape), np.pi * np.diag([0.1**2, 0.3**2]))
    np.testing.assert_allclose(added_inertia(shape), np.pi / 8 * (0.3**2 - 0.1**2) ** 2)


def test_of_a_spheroid_of_ratio_two():
    """k₁ = .2100, k₂ = .7042, k' = .2394 in Lamb's table, § 115; the last over the inertia of the fluid displaced."""
    shape = ellipsoid(2.0, 1.0, 1.0)
    np.testing.assert_allclose(np.diag(added_mass(shape)) / shape.volume, [0.2100, 0.7042, 0.7042], atol=5e-5)
    fluid = shape.volume * np.diag(shape.gyration)[1]
    np.testing.assert_allclose(np.diag(added_inertia(shape)) / fluid, [0.0, 0.2394, 0.2394], atol=5e-5)


def test_of_a_thin_plate():
    """A disk of radius c that moves broadside: 8c³/3; that turns over: 16c⁵/45."""
    shape = ellipsoid(1.0, 1.0, 1e-5)
    assert added_mass(shape)[2, 2] == pytest.approx(8 / 3, rel=1e-4)
    assert added_inertia(shape)[0, 0] == pytest.approx(16 / 45, rel=1e-4)
