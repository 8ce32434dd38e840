"""Added mass against Lamb's values."""

import numpy as np
import pytest
from mesh_tools import ball, ellipsoid

from rigidfluid.core.mechanics.added_mass import added_mass


def test_of_a_ball_half_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3, dimension=3)
    np.testing.assert_allclose(added_mass(shape), 0.5 * shape.volume * np.eye(3), rtol=1e-12)


def test_of_a_disk_the_mass_of_the_fluid_it_displaces():
    shape = ball(0.3)
    np.testing.assert_allclose(added_mass(shape), shape.volume * np.eye(2), rtol=1e-12)


def test_of_an_ellipse():
    shape = ellipsoid(0.3, 0.1)
    np.testing.assert_allclose(added_mass(shape), np.pi * np.diag([0.1**2, 0.3**2]))


def test_of_a_spheroid_of_ratio_two():
    """k₁ = .2100, k₂ = .7042 in Lamb's table, § 115."""
    shape = ellipsoid(2.0, 1.0, 1.0)
    np.testing.assert_allclose(np.diag(added_mass(shape)) / shape.volume, [0.2100, 0.7042, 0.7042], atol=5e-5)


def test_of_a_thin_plate():
    """A disk of radius c that moves broadside: 8c³/3."""
    shape = ellipsoid(1.0, 1.0, 1e-5)
    assert added_mass(shape)[2, 2] == pytest.approx(8 / 3, rel=1e-4)
